"""The printed equations against their own text, and the mended ones against Euler-Lagrange derived by computer algebra."""

from __future__ import annotations

import tomllib
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import sympy

from harness.cases.beams import PAPER_MASS, flexible_pendulum, strip
from harness.cases.pendulums import paper_pendulum
from harness.engines import registry
from harness.engines.as_printed import AsPrinted
from harness.engines.printed_terms import SLIPS, slips
from harness.engines.protocol import EngineError
from harness.errors import InputError, UnsupportedError

PUBLISHED = tomllib.loads((Path(__file__).parents[2] / "reference" / "paper.toml").read_text(encoding="utf-8"))
SYMBOLS = sympy.symbols("th dth ddth b db ddb rho l m_p I_h xi S0 S1 S2 S3 k xi_m g")
TH, DTH, DDTH, B, DB, DDB, RHO, L, M_P, I_H, XI, S0, S1, S2, S3, K, XI_M, G = SYMBOLS


def rigid():
    return paper_pendulum(damping=1.9e-3)


def flexible(**options):
    made = flexible_pendulum(strip(mass=PAPER_MASS, stiffening=False, payload=0.004, **options))
    link = made.links[0]
    made = replace(made, links=(replace(link, beam=replace(link.beam, modal_damping=(0.01,))),))
    return made.replace_joint(replace(made.joint("pivot"), damping=3e-4))


def correct():
    """Both rows by Euler-Lagrange, with the integrals of the shape function as symbols."""
    t = sympy.Symbol("t")
    angle, bent = sympy.Function("angle")(t), sympy.Function("bent")(t)
    w, v = angle.diff(t), bent.diff(t)
    # A point at x f + s b h: velocity (x w + s v) h − s b w f; gravity's potential −(x sinθ + s b cosθ) g.
    kinetic = (RHO * (L**3 / 3 * w**2 + S1 * (v**2 + bent**2 * w**2) + 2 * S2 * w * v) + I_H * w**2) / 2
    kinetic += M_P * ((L * w + S3 * v) ** 2 + (S3 * bent * w) ** 2) / 2
    potential = -G * (RHO * (L**2 / 2 * sympy.sin(angle) + S0 * bent * sympy.cos(angle)))
    potential += -G * M_P * (L * sympy.sin(angle) + S3 * bent * sympy.cos(angle)) + K * bent**2 / 2
    lagrangian = kinetic - potential
    rows = []
    for coordinate, rate, damping in ((angle, w, XI), (bent, v, XI_M)):
        row = lagrangian.diff(rate).diff(t) - lagrangian.diff(coordinate) + damping * rate
        row = row.subs([(angle.diff(t, 2), DDTH), (bent.diff(t, 2), DDB)])
        rows.append(row.subs([(w, DTH), (v, DB)]).subs([(angle, TH), (bent, B)]))
    return rows


def values(model, q, qd, qdd):
    """The paper's symbols at a state: θ is 90° + q where the link hangs at zero, b is against ours."""
    p, side = model.pendulum, model.side
    bent = [(side * a[1] if len(a) > 1 else 0.0) for a in (q, qd, qdd)]
    motion = [np.pi / 2 + q[0], qd[0], qdd[0], *bent]
    return [*motion, p.rho, p.l, p.m_p, p.I_h, p.xi, p.S0, p.S1, p.S2, p.S3, p.k, p.xi_m, 9.81]


def states(n, count=5):
    rng = np.random.default_rng(4)
    scale = np.array([1.0, 0.01])[:n]
    return [tuple(rng.normal(size=n) * scale * factor for factor in (1.0, 4.0, 30.0)) for _ in range(count)]


@pytest.mark.parametrize(
    ("system", "texts"),
    [
        (rigid, [PUBLISHED["equation_7"]["theta"]]),
        (flexible, [PUBLISHED["equation_10"]["theta"], PUBLISHED["equation_10"]["b"]]),
    ],
)
def test_as_printed_is_the_text_of_the_paper(system, texts):
    model = AsPrinted().build(system())
    rows = [sympy.lambdify(SYMBOLS, sympy.sympify(text, locals={str(s): s for s in SYMBOLS})) for text in texts]
    for q, qd, qdd in states(len(texts)):
        expected = (
            np.array([row(*values(model, q, qd, qdd)) for row in rows]) * np.array([1.0, model.side])[: len(rows)]
        )
        assert model.inverse_dynamics(q, qd, qdd) == pytest.approx(expected, rel=1e-12)


def test_all_mended_is_euler_lagrange():
    model = AsPrinted(("all",)).build(flexible())
    rows = [sympy.lambdify(SYMBOLS, row) for row in correct()]
    for q, qd, qdd in states(2):
        expected = np.array([row(*values(model, q, qd, qdd)) for row in rows]) * np.array([1.0, model.side])
        assert model.inverse_dynamics(q, qd, qdd) == pytest.approx(expected, rel=1e-11)


@pytest.mark.parametrize(("system", "peer"), [(rigid, "mujoco"), (rigid, "denoc"), (flexible, "denoc")])
def test_all_mended_is_what_other_engines_say(system, peer):
    ours, theirs = AsPrinted(("all",)).build(system()), registry.engine(peer).build(system())
    for q, qd, qdd in states(len(ours.names)):
        tau = theirs.inverse_dynamics(q, qd, qdd)
        assert ours.inverse_dynamics(q, qd, qdd) == pytest.approx(tau, rel=1e-11)
        assert ours.forward_dynamics(q, qd, tau) == pytest.approx(qdd, rel=1e-9)


@pytest.mark.parametrize("equation", [7, 10])
def test_mends_add_up_whatever_is_mended_already(equation):
    system = rigid() if equation == 7 else flexible()
    printed, every = AsPrinted().build(system), AsPrinted(("all",)).build(system)
    some = AsPrinted(tuple(slip.name for slip in slips(equation)[::2])).build(system)
    for at in states(len(every.names)):
        whole, part = every.mends(*at), some.mends(*at)
        assert printed.inverse_dynamics(*at) + sum(whole.values()) == pytest.approx(every.inverse_dynamics(*at))
        assert printed.inverse_dynamics(*at) + sum(part.values()) == pytest.approx(some.inverse_dynamics(*at))


def test_equation_7_to_the_letter_ends_at_the_vertical():
    model = AsPrinted().build(rigid())
    with pytest.raises(EngineError, match="no real acceleration"):
        model.simulate(np.array([-1.0]), np.zeros(1), np.linspace(0.0, 2.0, 201))


def test_it_is_had_by_name_and_is_no_peer():
    assert registry.engine("as_printed").name == "as_printed"
    assert "as_printed" not in registry.names()


def test_what_the_paper_has_no_equation_for_is_refused():
    engine = AsPrinted()
    assert "one mode" in (engine.refuses(flexible(modes=2)) or "")
    with pytest.raises(UnsupportedError):
        engine.build(flexible(modes=2))
    with pytest.raises(InputError, match="no misprint"):
        AsPrinted(("gravity_double",))
    assert len({(slip.equation, slip.name) for slip in SLIPS}) == len(SLIPS)
