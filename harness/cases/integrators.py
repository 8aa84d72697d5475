"""The native integrators one by one against the exact pendulum: error, and the order by which it falls with the step."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence

import numpy as np

from harness.cases.case import NATIVE, Array, Bench, Case, Row, Series
from harness.cases.checks import Measured
from harness.cases.pendulums import paper_pendulum, paper_small_frequency
from harness.compare.kinematics import broken
from harness.denoc import Denoc
from harness.denoc.lanes.model import LaneModel
from harness.engines.pendulum import swing
from harness.system import Trajectory

START, DURATION = 2.0, 3.0
# Method, step [s] at which its error stands well above rounding, its order, and the error allowed there [rad].
FIXED = (("rk4", 2.5e-3, 4.0, 2e-8), ("gauss", 2.5e-2, 6.0, 2e-8))
OFF_ORDER = 0.4
CITES = "φ'' = −ω² sin φ in Jacobi's functions, DLMF §22.19(i)"


def _exact(time: Array) -> Array:
    return swing(START, 0.0, 2.0 * np.pi * paper_small_frequency(), time)[0]


def fixed(bench: Bench) -> Iterable[Row | Series]:
    """Runge-Kutta of order four and Gauss-Legendre of order six, with the step they are told (it divides the samples')."""
    model = Denoc(bench.system)
    time = np.linspace(0.0, DURATION, 61)
    for method, step, order, allowed in FIXED:
        errors = [
            float(
                np.abs(
                    model.simulate([START], [0.0], time, method=method, step=length).position[:, 0] - _exact(time)
                ).max()
            )
            for length in (step, step / 2.0)
        ]

        def run(length: float, method: str = method) -> Trajectory:
            every = np.linspace(0.0, DURATION, round(DURATION / length) + 1)
            return model.simulate([START], [0.0], every, method=method, step=length)

        yield from _rows(bench, method, step, order, allowed, errors, run)


def _rows(
    bench: Bench,
    method: str,
    step: float,
    order: float,
    allowed: float,
    errors: Sequence[float],
    run: Callable[[float], Trajectory],
) -> Iterable[Row]:
    """Error and order of a method, and where one fails, which of its two integrals is wrong; run: with every step a sample."""
    found = float(np.log2(errors[0] / errors[1]))
    said, place = "", None
    if not (errors[0] <= allowed and abs(found - order) <= OFF_ORDER):
        model = Denoc(bench.system)
        wrong = broken(
            bench.system,
            run,
            lambda q, v: model.forward_dynamics(q, v, np.zeros(1)),
            step,
            order=order,
            allowed=allowed,
        )
        if wrong is not None:
            said, place = wrong.sentence(), {"term": wrong.term, "at": wrong.coordinate}
    about = {"method": method.replace("lanes_planar_", "lanes ").replace("lanes_spatial_", "lanes ")}
    yield bench.row(
        f"{method}_error",
        (NATIVE, "analytic"),
        errors[0],
        allowed,
        unit="rad",
        why=f"twice what the method leaves at {1e3 * step:g} ms on this swing",
        first_divergence=place,
        about=about,
        note=said,
        source=CITES,
    )
    yield bench.row(
        f"{method}_order",
        (NATIVE, "analytic"),
        abs(found - order),
        OFF_ORDER,
        why=f"halving the step divides the error by 2 to the {order:g}th; higher terms still show at this step",
        first_divergence=place,
        about=about,
        note="; ".join(filter(None, [f"{found:.2f} found", said])),
        source=CITES,
    )


def adaptive(bench: Bench) -> Iterable[Row | Series]:
    """The adaptive method at the tolerance it is told, its dense output included; with events another steps, SciPy's."""
    model = Denoc(bench.system)
    time = np.linspace(0.0, DURATION, 1234)

    def bottom(t: float, q: Array, qd: Array) -> float:
        return float(q[0])

    run = model.simulate([START], [0.0], time, method="dop853", events=[bottom])
    for quantity, found in (
        ("dop853_error", model.simulate([START], [0.0], time, method="dop853")),
        ("events_error", run),
    ):
        yield bench.row(
            quantity,
            (NATIVE, "analytic"),
            float(np.abs(found.position[:, 0] - _exact(time)).max()),
            1e-8,
            unit="rad",
            why="relative tolerance 1e-10 a step, samples between the steps",
            about={"method": quantity.removesuffix("_error")},
            source=CITES,
        )
    # A swing of amplitude A passes the bottom a quarter of a period after its release: K(sin²(A/2)) / ω.
    from scipy.special import ellipk

    quarter = float(ellipk(np.sin(0.5 * START) ** 2)) / (2.0 * np.pi * paper_small_frequency())
    passed = np.asarray(run.events["bottom"])
    true = quarter * (1.0 + 2.0 * np.arange(len(passed)))
    late = float(np.abs(passed - true).max()) if len(passed) == int((DURATION / quarter + 1.0) / 2.0) else np.inf
    yield bench.row(
        "event_time",
        (NATIVE, "analytic"),
        late,
        1e-8,
        unit="s",
        why="root of the dense output of a step",
        about={"term": "event_time"},
        source="a quarter of the period 4 K(sin²(A/2)) / ω",
    )


def held(bench: Bench) -> Iterable[Row | Series]:
    """Forces between samples, held and joined: a wheel's speed is their integral."""
    from harness.cases.rotor import INERTIA
    from harness.cases.rotor import system as rotor

    model = Denoc(rotor())
    time = np.array([0.0, 0.1, 0.25, 0.3, 0.7, 1.0])
    tau = np.array([0.01, -0.02, 0.03, 0.0, 0.02, 0.05])
    width = np.diff(time)
    for hold, area in (("zero", tau[:-1] * width), ("linear", 0.5 * (tau[:-1] + tau[1:]) * width)):
        true = np.concatenate([[0.0], np.cumsum(area)]) / INERTIA
        for method in ("dop853", "rk4", "gauss"):
            run = model.simulate([0.0], [0.0], time, tau=tau[:, None], hold=hold, method=method)
            yield bench.row(
                f"force_{hold}_{method}",
                (NATIVE, "analytic"),
                float(np.abs(run.velocity[:, 0] - true).max()),
                1e-9,
                unit="rad/s",
                why="no method of order two or more errs on a force that runs straight",
                about={"term": f"force between samples ({hold})", "method": method, "joint": "hub"},
                source="J ω(t) = ∫ τ dt",
            )


def held_in_lanes(bench: Bench) -> Iterable[Row | Series]:
    """The same in the lanes, where steps end between samples too."""
    from harness.cases.rotor import INERTIA
    from harness.cases.rotor import system as rotor

    time = np.linspace(0.0, 1.0, 6)
    tau = np.array([0.01, -0.02, 0.03, 0.0, 0.02, 0.05])
    for hold, mean in (("zero", tau[:-1]), ("linear", 0.5 * (tau[:-1] + tau[1:]))):
        true = np.concatenate([[0.0], np.cumsum(mean * np.diff(time))]) / INERTIA
        for planar in (True, False):
            model = LaneModel(rotor(), planar=planar)
            for method in ("adaptive", "rk4"):
                found = model.simulate(
                    model.row(), np.zeros(1), np.zeros(1), time, tau=tau[:, None], hold=hold, method=method, step=0.03
                )[1][0, :, 0]
                yield bench.row(
                    f"force_{hold}_lanes_{method}_{'planar' if planar else 'spatial'}",
                    (NATIVE, "analytic"),
                    float(np.abs(found - true).max()),
                    1e-9,
                    unit="rad/s",
                    why="no method of order two or more errs on a force that runs straight",
                    about={"term": f"force between samples ({hold})", "method": f"lanes {method}", "joint": "hub"},
                    source="J ω(t) = ∫ τ dt",
                )


def lanes(bench: Bench) -> Iterable[Row | Series]:
    """The steppers of the lanes, in the plane and in space."""
    time = np.linspace(0.0, DURATION, 61)
    for planar in (True, False):
        model = LaneModel(bench.system, planar=planar)
        kind = "planar" if planar else "spatial"
        found = model.simulate(model.row(), np.array([START]), np.zeros(1), time)[0][0, :, 0]
        yield bench.row(
            f"lanes_{kind}_error",
            (NATIVE, "analytic"),
            float(np.abs(found - _exact(time)).max()),
            1e-8,
            unit="rad",
            why="1e-11 a step",
            about={"method": "lanes adaptive"},
            source=CITES,
        )
        errors = [
            float(
                np.abs(
                    model.simulate(model.row(), np.array([START]), np.zeros(1), time, method="rk4", step=length)[0][
                        0, :, 0
                    ]
                    - _exact(time)
                ).max()
            )
            for length in (2.5e-3, 1.25e-3)
        ]

        def run(length: float, model: LaneModel = model) -> Trajectory:
            every = np.linspace(0.0, DURATION, round(DURATION / length) + 1)
            position, velocity = model.simulate(
                model.row(), np.array([START]), np.zeros(1), every, method="rk4", step=length
            )[:2]
            return Trajectory(every, bench.system.coordinate_names, position[0], velocity[0])

        yield from _rows(bench, f"lanes_{kind}_rk4", 2.5e-3, 4.0, 2e-8, errors, run)


CASE = Case(
    name="integrators",
    title="The native integrators one by one, on the paper's pendulum from 115°",
    source=CITES,
    system=paper_pendulum,
    checks=(
        Measured("fixed_steps", fixed),
        Measured("adaptive", adaptive),
        Measured("held_forces", held),
        Measured("held_forces_in_lanes", held_in_lanes),
        Measured("lanes", lanes),
    ),
    group="rigid",
    engines=(NATIVE,),
)
