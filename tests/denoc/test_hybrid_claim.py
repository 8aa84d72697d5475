"""The hybrid claim: N_dᵀ N_lᵀ ŵ = τ is Euler-Lagrange, shown by computer algebra, and it is what the kernels compute.

For planar links with polynomial shapes, energies and wrenches are integrated symbolically. Then

- Newton-Euler side: ŵ of each link is the integral of ρ [r̈ - g, (r - r_i) × (r̈ - g), partial velocities · (r̈ - g)];
- Lagrange side: d/dt ∂L/∂q̇ - ∂L/∂q of the same kinematics.

The difference of the two is a polynomial in coordinates, rates, accelerations and in cosines and sines of angles. For
one link it is expanded, with sin² = 1 - cos², to zero identically; for two flexible links it is evaluated in exact
rational arithmetic at random points (tangents of half angles rational), where a polynomial that is not zero has no
business vanishing.
"""

from __future__ import annotations

import random
from dataclasses import dataclass, replace
from functools import cache

import numpy as np
import pytest
import sympy as sp

from harness.denoc import Denoc
from harness.system import Beam, Joint, JointType, Link, System
from harness.system.flexible_link import flexible_link

t, x = sp.symbols("t x")
GRAVITY = sp.Rational(981, 100)
RIGIDITY = sp.Rational(1, 50)
SHAPES = (x**2, x**3)  # of the station from 0 to 1; not normalised, polynomials of the clamped kind


@dataclass(frozen=True)
class PlanarLink:
    """A planar link: length, mass, payload, EI and number of modes; rational, so that everything stays exact."""

    length: sp.Rational
    mass: sp.Rational
    payload: sp.Rational
    hub: sp.Rational
    modes: int = 0
    rigidity: sp.Rational = RIGIDITY
    stiffening: bool = True


def rational(a: int, b: int) -> sp.Rational:
    return sp.Rational(a, b)


FIRST = PlanarLink(rational(3, 10), rational(3, 50), rational(1, 50), rational(1, 5000))
SECOND = PlanarLink(rational(2, 5), rational(1, 10), rational(1, 100), rational(1, 3000))

CASES: dict[str, tuple[PlanarLink, ...]] = {
    "one rigid link": (FIRST,),
    "two rigid links": (FIRST, SECOND),
    "one flexible link, one mode": (replace(FIRST, modes=1),),
    "one flexible link, one mode, not stiffened": (replace(FIRST, modes=1, stiffening=False),),
    "one flexible link, two modes": (replace(FIRST, modes=2),),
    "two flexible links, one mode each": (replace(FIRST, modes=1), replace(SECOND, modes=1)),
    "flexible link bears rigid link": (replace(FIRST, modes=1), SECOND),
}


def perpendicular(a: sp.Matrix) -> sp.Matrix:
    return sp.Matrix([-a[1], a[0]])


def cross(a: sp.Matrix, b: sp.Matrix) -> sp.Expr:
    return a[0] * b[1] - a[1] * b[0]


@dataclass(frozen=True)
class Equations:
    """Both sides for coordinates q(t), in terms of plain symbols; sines and cosines are symbols tied to their angles."""

    lagrange: tuple[sp.Expr, ...]
    denoc: tuple[sp.Expr, ...]
    symbols: tuple[tuple[sp.Symbol, sp.Symbol, sp.Symbol], ...]
    angles: tuple[tuple[sp.Symbol, sp.Symbol, sp.Expr], ...]


class Trigonometry:
    """Direction of an angle as a pair of functions of time whose derivative is known, so that no sine is ever expanded."""

    def __init__(self) -> None:
        self.found: list[tuple[sp.Function, sp.Function, sp.Expr]] = []

    def direction(self, angle: sp.Expr) -> tuple[sp.Expr, sp.Expr]:
        k = len(self.found)
        c, s = sp.Function(f"c{k}")(t), sp.Function(f"s{k}")(t)
        self.found.append((c, s, angle))
        return c, s

    def rate(self, expression: sp.Expr) -> sp.Expr:
        """d/dt with d cos = -sin dφ, d sin = cos dφ."""
        result = sp.diff(expression, t)
        for c, s, angle in self.found:
            turning = sp.diff(angle, t)
            result = result.subs({sp.diff(c, t): -s * turning, sp.diff(s, t): c * turning})
        return result

    def partial(self, expression: sp.Expr, q: sp.Expr) -> sp.Expr:
        result = sp.diff(expression, q)
        for c, s, angle in self.found:
            share = sp.diff(angle, q)
            if share != 0:
                result += share * (sp.diff(expression, s) * c - sp.diff(expression, c) * s)
        return result


@cache
def equations(case: str) -> Equations:
    """Euler-Lagrange and DeNOC of a planar chain that hangs from a hinge; θ counterclockwise from the downward vertical."""
    links = CASES[case]
    trig = Trigonometry()
    coordinates: list[sp.Expr] = []
    kinetic, potential = sp.S(0), sp.S(0)
    base, turned = sp.zeros(2, 1), sp.S(0)
    down = sp.Matrix([0, -GRAVITY])
    placed = []
    for i, link in enumerate(links):
        angle = sp.Function(f"theta{i}")(t)
        modal = [sp.Function(f"b{i}{k}")(t) for k in range(link.modes)]
        turned = turned + angle
        c, s = trig.direction(turned)
        f, h = sp.Matrix([s, -c]), sp.Matrix([c, s])
        deflection = sum((b * shape for b, shape in zip(modal, SHAPES, strict=False)), sp.S(0))
        # Foreshortening ½ ∫ (∂u/∂ξ)² dξ along the beam; the station is x l.
        slope = sp.diff(deflection, x) / link.length
        short = sp.integrate(sp.expand(slope**2), (x, 0, x)) * link.length / 2 if link.stiffening else sp.S(0)
        place = base + (x * link.length - short) * f + deflection * h
        density = link.mass
        bend = sp.integrate(sp.expand(sp.diff(deflection, x, 2) ** 2), (x, 0, 1)) / link.length**3 * link.rigidity
        placed.append((link, angle, modal, base, place))
        velocity = place.applyfunc(trig.rate)
        speed = sp.expand((velocity.T * velocity)[0])
        kinetic += density * sp.integrate(speed, (x, 0, 1)) / 2 + link.payload * speed.subs(x, 1) / 2
        kinetic += link.hub * sp.diff(angle, t) ** 2 / 2
        height = sp.expand(-(down.T * place)[0])
        potential += density * sp.integrate(height, (x, 0, 1)) + link.payload * height.subs(x, 1) + bend / 2
        coordinates += [angle, *modal]
        base = place.subs(x, 1)
        turned = turned + slope.subs(x, 1)
    rates = [sp.diff(q, t) for q in coordinates]

    lagrange = []
    for q, v in zip(coordinates, rates, strict=True):
        lagrange.append(trig.rate(sp.diff(kinetic, v)) - trig.partial(kinetic, q) + trig.partial(potential, q))

    # Newton-Euler: wrench of each link about its origin, with its modal components, then N_lᵀ inwards and N_dᵀ out.
    denoc: list[sp.Expr] = []
    force, moment = sp.zeros(2, 1), sp.S(0)
    for i in range(len(links) - 1, -1, -1):
        link, angle, modal, origin, place = placed[i]
        reaction = place.applyfunc(lambda e: trig.rate(trig.rate(e))) - down
        arm = place - origin
        partials = [place.applyfunc(lambda e, b=b: trig.partial(e, b)) for b in modal]

        def over_mass(e: sp.Expr, link: PlanarLink = link) -> sp.Expr:
            e = sp.expand(e)
            return link.mass * sp.integrate(e, (x, 0, 1)) + link.payload * e.subs(x, 1)

        own_force = reaction.applyfunc(over_mass)
        own_moment = over_mass(cross(arm, reaction))
        own_modal = [over_mass((partial.T * reaction)[0]) for partial in partials]
        # What the next link hands on, (moment, force) at this link's tip: rigid shift, and the tip's partial twists.
        tip = place.subs(x, 1) - origin
        for k, partial in enumerate(partials):
            turning = sp.diff(SHAPES[k], x).subs(x, 1) / link.length
            own_modal[k] += (partial.subs(x, 1).T * force)[0] + turning * moment
        moment = own_moment + moment + cross(tip, force)
        force = own_force + force
        stiffness = [
            link.rigidity
            / link.length**3
            * sum(
                modal[l] * sp.integrate(sp.diff(SHAPES[k], x, 2) * sp.diff(SHAPES[l], x, 2), (x, 0, 1))
                for l in range(link.modes)
            )
            for k in range(link.modes)
        ]
        elastic = [w + k for w, k in zip(own_modal, stiffness, strict=True)]
        denoc = [moment + link.hub * sp.diff(angle, t, 2), *elastic, *denoc]

    symbols = []
    swap = {}
    for k, q in enumerate(coordinates):
        triple = tuple(sp.Symbol(f"{name}{k}") for name in ("q", "v", "a"))
        swap |= {sp.diff(q, t, 2): triple[2], sp.diff(q, t): triple[1], q: triple[0]}
        symbols.append(triple)

    def plain(e: sp.Expr) -> sp.Expr:
        for old, new in swap.items():
            e = e.subs(old, new)
        for k, (c, s, _) in enumerate(trig.found):
            e = e.subs({c: sp.Symbol(f"C{k}"), s: sp.Symbol(f"S{k}")})
        return e

    angles = tuple((sp.Symbol(f"C{k}"), sp.Symbol(f"S{k}"), plain(angle)) for k, (_, _, angle) in enumerate(trig.found))
    return Equations(tuple(map(plain, lagrange)), tuple(map(plain, denoc)), tuple(symbols), angles)


@pytest.mark.parametrize("case", [name for name in CASES if name.startswith("one")])
def test_newton_euler_is_lagrange_identically(case: str) -> None:
    both = equations(case)
    squares = {s**2: 1 - c**2 for c, s, _ in both.angles}
    for one, other in zip(both.lagrange, both.denoc, strict=True):
        difference = sp.expand(one - other)
        difference = sp.expand(difference.subs(squares))
        assert difference == 0
        assert sp.expand(one) != 0


@pytest.mark.slow
@pytest.mark.parametrize("case", CASES)
def test_newton_euler_is_lagrange_at_rational_points(case: str) -> None:
    both = equations(case)
    source = random.Random(5)

    def draw() -> sp.Rational:
        return sp.Rational(source.randint(-60, 60), source.randint(1, 30))

    for _ in range(4):
        at = {symbol: draw() for triple in both.symbols for symbol in triple}
        for c, s, _ in both.angles:
            half = draw()
            at |= {c: (1 - half**2) / (1 + half**2), s: 2 * half / (1 + half**2)}
        for one, other in zip(both.lagrange, both.denoc, strict=True):
            value = one.xreplace(at)
            assert sp.nsimplify(value - other.xreplace(at)) == 0
            assert value != 0


def planar_system(links: tuple[PlanarLink, ...]) -> System:
    """The same chain as a system: hinges about -y, so that x is to the right and z up as in the plane above."""
    joints, bodies = [], []
    parent, at = "base", np.zeros(3)
    for i, link in enumerate(links):
        name, length = f"link{i}", float(link.length)
        joints.append(
            Joint(
                f"hinge{i}",
                JointType.REVOLUTE,
                parent,
                name,
                xyz=at,
                axis=np.array([0.0, -1, 0]),
                armature=float(link.hub),
            )
        )
        stations = np.linspace(0.0, 1.0, 9)
        samples = np.column_stack([stations, *([stations**2, stations**3][: link.modes])])
        direction = np.array([0.0, 0.0, -1.0])
        beam = Beam(
            length=length,
            direction=direction,
            bending=np.array([1.0, 0.0, 0.0]),
            mass=float(link.mass),
            bending_stiffness=float(link.rigidity),
            modes=max(link.modes, 1),
            payload=float(link.payload),
            geometric_stiffening=link.stiffening,
            shapes="samples" if link.modes else "auto",
            shape_samples=samples if link.modes else None,
        )
        body = flexible_link(name, beam)
        bodies.append(body if link.modes else Link(name, body.mass, body.com, body.inertia))
        parent, at = name, direction * length
    gravity = np.array([0.0, 0.0, -float(GRAVITY)])
    return System("planar", tuple(joints), tuple(bodies), gravity=gravity)


@pytest.mark.parametrize("case", CASES)
def test_kernels_compute_the_same(case: str) -> None:
    both = equations(case)
    model = Denoc(planar_system(CASES[case]))
    flat = [symbol for triple in both.symbols for symbol in triple]
    circles = [symbol for c, s, _ in both.angles for symbol in (c, s)]
    sides = sp.lambdify([*flat, *circles], both.lagrange, "math")
    turn = sp.lambdify(flat, [angle for _, _, angle in both.angles], "math")
    rng = np.random.default_rng(1)
    joints = np.array(["mode" not in name for name in model.names])
    for _ in range(5):
        q = np.where(joints, rng.uniform(-3.0, 3.0, model.n), rng.uniform(-0.03, 0.03, model.n))
        qd, qdd = rng.normal(size=(2, model.n))
        values = [value for triple in zip(q, qd, qdd, strict=True) for value in triple]
        angles = turn(*values)
        expected = np.array(sides(*values, *[f(a) for a in angles for f in (np.cos, np.sin)]))
        found = model.inverse_dynamics(q, qd, qdd)
        assert np.abs(found - expected).max() < 1e-11 * np.abs(expected).max()
        assert np.abs(model.forward_dynamics(q, qd, expected) - qdd).max() < 1e-8 * np.abs(qdd).max()


def test_the_papers_rigid_pendulum_corrected() -> None:
    """(ρl³/3 + m_p l² + I_h) θ̈ + ξ θ̇ = (ρl²/2 + m_p l) g cosθ, θ from horizontal and positive downward."""
    l, mass, payload, hub, damping, g = 0.3, 0.18, 0.02, 2e-5, 1.9e-3, 9.81
    link = planar_system((PlanarLink(sp.Rational(3, 10), sp.Rational(9, 50), sp.Rational(1, 50), sp.S(0)),))
    hinge = Joint(
        "pivot", JointType.REVOLUTE, "base", "link0", axis=np.array([0.0, -1, 0]), armature=hub, damping=damping
    )
    model = Denoc(replace(link, joints=(hinge,)))
    rho = mass / l
    for theta, rate in ((0.0, 0.0), (0.7, -2.0), (2.5, 3.0)):
        expected = ((rho * l**2 / 2 + payload * l) * g * np.cos(theta) - damping * rate) / (
            rho * l**3 / 3 + payload * l**2 + hub
        )
        # Ours: from the downward vertical, the other way round.
        found = -model.forward_dynamics(np.array([np.pi / 2 - theta]), np.array([-rate]))[0]
        assert found == pytest.approx(expected, rel=1e-13)


def test_the_papers_flexible_pendulum_corrected() -> None:
    """Equation (10) with ρ, m_p, the centrifugal term and the stiffness where they belong; s = (x/l)², one mode."""
    l, mass, payload, hub, g, rigidity = 0.3, 0.06, 0.02, 2e-4, 9.81, 0.02
    link = PlanarLink(FIRST.length, FIRST.mass, FIRST.payload, FIRST.hub, modes=1, stiffening=False)
    model = Denoc(planar_system((link,)))
    rho = mass / l
    # ∫ (x/l)² dx, ∫ (x/l)⁴ dx, ∫ x (x/l)² dx, s(l), EI ∫ (2/l²)² dx.
    S0, S1, S2, S3, k = l / 3, l / 5, l**2 / 4, 1.0, rigidity * 4 / l**3
    rng = np.random.default_rng(2)
    for _ in range(5):
        theta, b = rng.uniform(-3, 3), rng.uniform(-0.03, 0.03)
        dtheta, db, ddtheta, ddb = rng.normal(size=4)
        first = (
            (rho * (l**3 / 3 + S1 * b**2) + payload * (l**2 + S3**2 * b**2) + hub) * ddtheta
            + (rho * S2 + payload * l * S3) * ddb
            + 2 * (rho * S1 + payload * S3**2) * b * db * dtheta
            - (rho * l**2 / 2 + payload * l) * g * np.cos(theta)
            + (rho * S0 + payload * S3) * g * b * np.sin(theta)
        )
        second = (
            (rho * S2 + payload * l * S3) * ddtheta
            + (rho * S1 + payload * S3**2) * ddb
            - (rho * S1 + payload * S3**2) * b * dtheta**2
            + k * b
            - (rho * S0 + payload * S3) * g * np.cos(theta)
        )
        # Downward angle and deflection are the opposite of ours, which turn counterclockwise from the vertical.
        found = model.inverse_dynamics(
            np.array([np.pi / 2 - theta, -b]), np.array([-dtheta, -db]), np.array([-ddtheta, -ddb])
        )
        assert np.abs([found[0] + first, found[1] + second]).max() < 1e-12 * max(abs(first), abs(second))
