"""What a beam carries and how it dies away: payload with inertia, torsion, the second plane, damping, strain, tip acceleration."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable
from dataclasses import replace
from typing import Any

import numpy as np
from scipy.optimize import brentq, least_squares

from harness.cases.beams import LENGTH, cantilever, closed_form, flexible_pendulum, strip
from harness.cases.case import NATIVE, Bench, Case, Row, Series
from harness.cases.checks import Measured
from harness.cases.checks.beam_blame import by_frequencies
from harness.cases.checks.closed_form_blame import Times, Truth, by_truth, once
from harness.denoc import Denoc
from harness.errors import UnsupportedError
from harness.system import Beam, Link, System
from harness.system.description import constant
from harness.system.flexible_link import flexible_link

CLAMPED_FREE = (1.8751040687119611, 4.694091132974175, 7.854757438237613)
PAYLOAD = 0.02  # kg
STIFF = 1e4  # N·m², of a plane whose modes are to come after those that are looked at
SWING = 1e-5  # m, of vibrations that are to be linear


def system() -> System:
    return cantilever(strip(modes=5))


def _with(**changes: Any) -> Link:
    """The strip with other numbers, its whole mass and inertia following."""
    beam = strip(modes=5).beam
    assert beam is not None
    return flexible_link("rod", replace(beam, **changes))


def _beam(link: Link) -> Beam:
    assert link.beam is not None
    return link.beam


def tip_mass_roots(mass: float, inertia: float, count: int) -> list[float]:
    """Roots β l of a clamped beam that carries a mass and a rotary inertia, as shares of ρ l and ρ l³, at its tip.

    Shear force EI u''' = -m ω² u and moment EI u'' = J ω² u' at the tip; u = A (cosh − cos) + B (sinh − sin) in x β.
    """

    def determinant(z: float) -> float:
        ch, sh, c, s = math.cosh(z), math.sinh(z), math.cos(z), math.sin(z)
        value, slope = (ch - c, sh - s), (sh + s, ch - c)
        curvature, third = (ch + c, sh + s), (sh - s, ch + c)
        moment = [k - inertia * z**3 * d for k, d in zip(curvature, slope, strict=True)]
        shear = [t + mass * z * v for t, v in zip(third, value, strict=True)]
        return (moment[0] * shear[1] - moment[1] * shear[0]) / math.cosh(z) ** 2

    grid = np.linspace(0.05, 20.0, 4000)
    signs = np.sign([determinant(z) for z in grid])
    found = [
        float(brentq(determinant, grid[k], grid[k + 1], xtol=1e-14)) for k in np.flatnonzero(signs[1:] != signs[:-1])
    ]
    return found[:count]


def payload(bench: Bench) -> Iterable[Row | Series]:
    """A payload with rotary inertia at the tip."""
    inertia = 2e-5
    link = _with(payload=PAYLOAD, payload_inertia=constant(np.diag([inertia, inertia, inertia])))
    beam = _beam(link)

    def truth(times: Times) -> np.ndarray:
        mass = beam.mass * times("mass")
        roots = tip_mass_roots(
            PAYLOAD * times("payload") / mass, inertia * times("payload_inertia") / (mass * LENGTH**2), 2
        )
        speed = math.sqrt(times("bending_stiffness") / times("mass"))
        return speed * np.array([closed_form(root, link) for root in roots])

    names = ("payload_inertia", "payload", "bending_stiffness", "mass")
    found = _lowest(link)
    cites = "clamped beam with mass and rotary inertia at its tip, characteristic equation"
    yield _frequency(bench, "payload_inertia", found, truth, names, cites)


def torsion(bench: Bench) -> Iterable[Row | Series]:
    """Torsion of a clamped beam: (2k − 1)/4l √(GJ / ρ I_p)."""
    stiffness, polar = 0.05, 4e-6
    link = _with(torsion_modes=2, torsional_stiffness=stiffness, polar_inertia=polar, bending_stiffness=STIFF)

    def truth(times: Times) -> np.ndarray:
        speed = math.sqrt(stiffness * times("torsional_stiffness") / (polar * times("polar_inertia")))
        return speed * np.array([(2 * k - 1) / (4.0 * LENGTH) for k in (1, 2)])

    names = ("torsional_stiffness", "polar_inertia")
    yield _frequency(bench, "torsion", _lowest(link), truth, names, "(2k − 1)/4l √(GJ / ρ I_p)")


def torsion_with_payload(bench: Bench) -> Iterable[Row | Series]:
    """A shaft with an inertia at its end: z tan z = (ρ I_p l) / J."""
    stiffness, polar, inertia = 0.05, 4e-6, 6e-7
    link = _with(
        torsion_modes=2,
        torsional_stiffness=stiffness,
        polar_inertia=polar,
        payload_inertia=constant(np.diag([0.0, 0.0, inertia])),
        bending_stiffness=STIFF,
    )

    def truth(times: Times) -> np.ndarray:
        shaft = polar * times("polar_inertia")
        own = shaft * LENGTH / (inertia * times("payload_inertia"))
        ends = [(k * math.pi, (k + 0.5) * math.pi) for k in (0, 1)]
        roots = [brentq(lambda z: z * math.sin(z) - own * math.cos(z), *end) for end in ends]
        speed = math.sqrt(stiffness * times("torsional_stiffness") / shaft)
        return speed * np.array(roots) / (2.0 * math.pi * LENGTH)

    names = ("payload_inertia", "polar_inertia", "torsional_stiffness")
    cites = "z tan z = ρ I_p l / J of a clamped shaft with an inertia at its end"
    yield _frequency(bench, "torsion_payload", _lowest(link), truth, names, cites)


def second_plane(bench: Bench) -> Iterable[Row | Series]:
    """Bending across, with a stiffness of its own."""
    link = _with(bending2=True, bending_stiffness=STIFF, bending_stiffness2=2.7)
    across = replace(link, beam=replace(_beam(link), bending_stiffness=2.7))

    def truth(times: Times) -> np.ndarray:
        speed = math.sqrt(times("bending_stiffness2") / times("mass"))
        return speed * np.array([closed_form(root, across) for root in CLAMPED_FREE[:2]])

    yield _frequency(
        bench, "second_plane", _lowest(link), truth, ("bending_stiffness2", "mass"), "(β l)² √(EI₂/ρ) / 2π l²"
    )


def _lowest(link: Link) -> np.ndarray:
    """The two lowest frequencies [Hz]; were two planes alike, each would be there twice."""
    every = np.sort(Denoc(cantilever(link)).frequencies())
    return np.asarray(every[np.append(True, np.diff(every) > 1e-6 * every[1:])][:2])


def _frequency(bench: Bench, quantity: str, found: np.ndarray, truth: Truth, names: tuple[str, ...], cites: str) -> Row:
    allowed, true = 1e-9, truth(once)
    errors = np.abs(found - true) / true
    worst = int(np.argmax(errors))
    note = f"mode {worst + 1}: {found[worst]:.8g} Hz against {true[worst]:.8g} Hz"
    place: dict[str, object] | None = None
    if not errors[worst] <= allowed:
        said, where = by_truth("rod", truth, names, found)
        note, place = f"{note}; {said}", {"mode": worst + 1} | where
    return bench.row(
        f"{quantity}_frequency",
        (NATIVE, "analytic"),
        float(errors[worst]),
        allowed,
        why="the shapes are the exact ones, payload and inertia included",
        note=note,
        first_divergence=place,
        source=cites,
    )


def damping(bench: Bench) -> Iterable[Row | Series]:
    """A mode dies away as exp(−ζ ω t): by Kelvin-Voigt material ζ = c ω / 2, by its own ratio as it is told."""
    material, ratio = 2e-4, 0.013
    omega = 2.0 * np.pi * closed_form(CLAMPED_FREE[0], strip())
    for quantity, zeta, changes in (
        ("material_damping", 0.5 * material * omega, {"material_damping": material}),
        ("modal_damping", ratio, {"modal_damping": (ratio,)}),
    ):
        model = Denoc(cantilever(_with(modes=1, **changes)))
        time = np.linspace(0.0, 0.5, 501)
        run = model.simulate([SWING], [0.0], time)
        found = run.position[:, 0] / SWING
        apart = float(np.abs(found - _dying(time, omega, zeta)).max())
        note, place = f"damping ratio {zeta:.4g}", None
        if not apart <= 1e-6:
            said, place = _what_dies_otherwise(time, found, omega, zeta, quantity)
            note = f"{note}; {said}"
        yield bench.row(
            f"{quantity}_decay",
            (NATIVE, "analytic"),
            apart,
            1e-6,
            why="the integrator's tolerance; stiffening is of second order in a swing of 10 µm",
            note=note,
            first_divergence=place,
            source="ζ = c ω / 2 (Kelvin-Voigt); x = e^(−ζωt) (cos ω_d t + ζ/√(1 − ζ²) sin ω_d t)",
        )


def _dying(time: np.ndarray, omega: float, zeta: float) -> np.ndarray:
    """Free motion from one, at rest, of an oscillator."""
    turn = omega * math.sqrt(1.0 - zeta**2)
    return np.asarray(
        np.exp(-zeta * omega * time) * (np.cos(turn * time) + zeta / math.sqrt(1.0 - zeta**2) * np.sin(turn * time))
    )


def _what_dies_otherwise(
    time: np.ndarray, found: np.ndarray, omega: float, zeta: float, damping: str
) -> tuple[str, dict[str, object] | None]:
    """Whether a mode dies away or swings otherwise than it should, by the ratio and frequency that it has."""
    fitted = least_squares(
        lambda x: _dying(time, x[0] * omega, min(x[1] * zeta, 0.9)) - found, (1.0, 1.0), x_scale=1e-3
    )
    if not fitted.success or np.abs(fitted.fun).max() > 1e-3:
        return "it is no mode that dies away", {"link": "rod", "value": damping}
    frequency, ratio = (float(x) for x in fitted.x)
    if abs(ratio - 1.0) > abs(frequency - 1.0):
        return f"as with {damping.replace('_', ' ')} {ratio:.6g} times as large", {"link": "rod", "value": damping}
    return f"its frequency is {frequency:.8g} times what it should be", {"link": "rod", "value": "beam", "mode": 1}


def hinged_damping(bench: Bench) -> Iterable[Row | Series]:
    """Ratios of the modes of a strip that turns freely with its hub, payload at the tip: from (λ² M + λ C + K) v = 0."""
    ratios = (0.01, 0.02)
    model = Denoc(flexible_pendulum(_with(modes=2, modal_damping=ratios, payload=PAYLOAD), gravity=0.0))
    stiffness, damping = model.linear_passive()
    mass, n = model.mass_matrix(np.zeros(model.n)), model.n
    lower = np.linalg.solve(mass, np.hstack([-stiffness, -damping]))
    whole = np.linalg.eigvals(np.vstack([np.hstack([np.zeros((n, n)), np.eye(n)]), lower]))
    roots = sorted((root for root in whole if root.imag > 1.0), key=lambda root: float(root.imag))
    found = np.array([-root.real / abs(root) for root in roots])
    apart = float(np.abs(found - ratios).max() / ratios[0]) if found.shape == (2,) else np.inf
    yield bench.row(
        "modal_damping_hinged",
        (NATIVE, "analytic"),
        apart,
        1e-9,
        why="the modes are those that the ratios are of",
        note=", ".join(f"{ratio:.6g}" for ratio in found),
        about={"link": "rod", "value": "modal_damping"},
        source="λ = −ζ ω ± i ω √(1 − ζ²), ζ as it is told",
    )


def at_rest(bench: Bench) -> Iterable[Row | Series]:
    """What one mode leaves out of a level cantilever's sag is in what its sensors read."""
    g, rigidity = 9.81, 50.0
    link = _with(modes=1, payload=PAYLOAD, bending_stiffness=rigidity)
    beam = _beam(link)
    model = Denoc(replace(cantilever(link), gravity=constant([g, 0.0, 0.0])))
    sagged = np.linalg.solve(model.linear_passive()[0], -model.gravity(np.zeros(1)))
    read = model.simulate(sagged, [0.0], np.array([0.0, 1e-4])).channels
    bend = beam.mass * g * LENGTH / 2.0 + PAYLOAD * g * LENGTH
    tip = beam.mass * g * LENGTH**3 / (8.0 * rigidity) + PAYLOAD * g * LENGTH**3 / (3.0 * rigidity)
    for channel, true, cites in (
        ("tip_deflection", tip, "w l⁴/8EI + P l³/3EI"),
        ("root_strain", beam.half_depth * bend / rigidity, "h (w l²/2 + P l)/EI"),
    ):
        yield bench.row(
            f"{channel}_at_rest",
            (NATIVE, "analytic"),
            abs(float(read[f"rod.{channel}"][0]) - true) / true,
            2e-5,
            why="a sag of some millimetres, of which the square is left out",
            about={"link": "rod", "term": channel},
            source=cites,
        )


def sensors(bench: Bench) -> Iterable[Row | Series]:
    """In its first mode a clamped strip's root strain is half its depth times β² of the tip's deflection, its tip's
    acceleration −ω² of it; weight is read where nothing moves."""
    model = Denoc(cantilever(_with(modes=1)))
    root = CLAMPED_FREE[0]
    omega = 2.0 * np.pi * closed_form(root, strip())
    time = np.linspace(0.0, 0.2, 201)
    channels = model.simulate([SWING], [0.0], time).channels
    tip = channels["rod.tip_deflection"]
    peak = float(np.abs(tip).max())
    half = _beam(strip()).half_depth
    why = "linear in a swing of 10 µm"
    for channel, factor, cites in (
        # |φ(l)| = 2 and φ''(0) = 2 β² of the clamped-free shape.
        ("root_strain", half * (root / LENGTH) ** 2, "φ''(0) = β² |φ(l)| of the clamped-free shape; strain = h φ''(0)"),
        ("tip_acceleration", -(omega**2), "ü = −ω² u"),
    ):
        apart = float(np.abs(channels[f"rod.{channel}"] - factor * tip).max()) / (abs(factor) * peak)
        about = {"link": "rod", "term": channel}
        yield bench.row(channel, (NATIVE, "analytic"), apart, 1e-5, why=why, source=cites, about=about)
    level = Denoc(replace(cantilever(_with(modes=1, bending_stiffness=1e4)), gravity=constant([-9.81, 0.0, 0.0])))
    sagged = np.linalg.solve(level.linear_passive()[0], -level.gravity(np.zeros(1)))
    read = level.simulate(sagged, [0.0], np.linspace(0.0, 0.01, 11)).channels["rod.tip_acceleration"]
    yield bench.row(
        "tip_acceleration_at_rest",
        (NATIVE, "analytic"),
        float(np.abs(read - 9.81).max()) / 9.81,
        1e-5,
        why="a beam that hardly sags, in balance: its tip turns by less than a milliradian",
        about={"link": "rod", "term": "tip_acceleration"},
        source="an accelerometer at rest reads what holds it up against gravity",
    )


def static(bench: Bench) -> Iterable[Row | Series]:
    """Weight of strip and payload: tip deflection and root strain about which a level cantilever vibrates."""
    link = _with(payload=PAYLOAD, bending_stiffness=50.0)
    beam = _beam(link)
    g = 9.81
    model = Denoc(replace(cantilever(link), gravity=constant([g, 0.0, 0.0])))
    b = np.linalg.solve(model.linear_passive()[0], -model.gravity(np.zeros(model.n)))
    data = model.beams[1]
    deflection = float(b @ data.tip.s)
    true = beam.mass * g * LENGTH**3 / (8.0 * 50.0) + PAYLOAD * g * LENGTH**3 / (3.0 * 50.0)
    yield bench.row(
        "static_deflection",
        (NATIVE, "analytic"),
        abs(deflection - true) / true,
        1e-4,
        why="five shapes of the strip with its payload; a sixth adds 1e-5",
        about={"link": "rod", "term": "linear_passive"},
        source="w l⁴/8EI + P l³/3EI",
    )


def against_ancf(bench: Bench) -> Iterable[Row | Series]:
    """A hanging strip with a payload swings by the weight of both: a cable's payload must weigh."""
    hanging = flexible_pendulum(strip(modes=5, payload=PAYLOAD))
    ours = Denoc(hanging).frequencies()[:2]
    for name in ("exudyn_ancf",):
        if name not in bench.models:
            continue
        try:
            theirs = np.sort(bench.build(name, hanging).frequencies(np.zeros(len(hanging.coordinate_names))))[:2]
        except UnsupportedError as reason:
            yield bench.skipped("payload_weight", (NATIVE, name), str(reason))
            continue
        errors = np.abs(ours - theirs) / ours
        note = ", ".join(f"{a:.6g} against {b:.6g} Hz" for a, b in zip(ours, theirs, strict=True))
        place: dict[str, object] | None = None
        if not errors.max() <= 2e-5:
            ratios = dict(enumerate(theirs / ours))
            said, place = by_frequencies(hanging, name, ours, ratios, mode=int(np.argmax(errors)))
            note = f"{note}; {said}"
        yield bench.row(
            "payload_weight",
            (NATIVE, name),
            float(errors.max()),
            2e-5,
            why="sixteen cables leave 1e-6; the swing hangs on gravity alone, the first bending on the payload's inertia",
            note=note,
            first_divergence=place,
            about={"link": "rod", "value": "payload"},
        )


_CHECKS: tuple[tuple[str, Callable[[Bench], Iterable[Row | Series]]], ...] = (
    ("payload_inertia", payload),
    ("torsion", torsion),
    ("torsion_payload", torsion_with_payload),
    ("second_plane", second_plane),
    ("damping", damping),
    ("hinged_damping", hinged_damping),
    ("at_rest", at_rest),
    ("sensors", sensors),
    ("static", static),
    ("payload_weight", against_ancf),
)

CASE = Case(
    name="beam_paths",
    title="What a beam carries and how it dies away: payload, torsion, second plane, damping, strain, tip acceleration",
    source="R. D. Blevins, Formulas for Natural Frequency and Mode Shape (1979); closed forms of Euler-Bernoulli beams",
    system=system,
    checks=tuple(Measured(quantity, function) for quantity, function in _CHECKS),
    group="flexible",
    engines=(NATIVE, "exudyn_ancf"),
)
