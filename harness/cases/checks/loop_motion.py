"""Motion of closed mechanisms against engines that hold loops in other ways, and whether loops stay closed."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass, replace

import numpy as np

from harness.cases.case import NATIVE, Array, Bench, Row, Series
from harness.cases.checks.equation_blame import Told, blamed
from harness.cases.checks.trajectory import initial_state
from harness.compare.divergence_shape import left_line
from harness.engines.protocol import EngineModel

# Time constants [s] that MuJoCo's equality constraints are given in turn, and the steps [s] they are run at.
SOFT = ((2e-2, 1e-4), (5e-3, 1e-4), (1e-3, 1e-4), (2e-4, 1e-4), (5e-5, 2.5e-5))
# Steps [s] of Exudyn's runs; its error is of second order, which two of them take out.
STEPS = (1e-3, 5e-4)
SAMPLES = 101


@dataclass(frozen=True)
class LoopMotion:
    """Largest difference of a joint position between the native motion and each engine's, from one state.

    position, velocity: initial state by coordinate name; the rest is what closes the loops. duration [s].
    pinocchio, mujoco, exudyn: differences that are allowed [rad or m], None where the engine is not asked.
    """

    position: tuple[tuple[str, float], ...] = ()
    velocity: tuple[tuple[str, float], ...] = ()
    duration: float = 0.5
    pinocchio: float | None = 1e-8
    mujoco: float | None = 1e-7
    exudyn: float | None = 1e-6
    quantity: str = "loop_motion"

    def run(self, bench: Bench) -> Iterable[Row | Series]:
        start = initial_state(bench.system, dict(self.position), dict(self.velocity))
        time = np.linspace(0.0, self.duration, SAMPLES)
        ours = bench.models[NATIVE].simulate(*start, time).position
        asked: dict[str, tuple[float | None, Callable[..., Iterable[Row | Series]]]] = {
            "pinocchio": (self.pinocchio, self._integrated),
            "mujoco": (self.mujoco, self._soft),
            "exudyn": (self.exudyn, self._stepped),
        }
        for name, (allowed, compare) in asked.items():
            if name in bench.models and allowed is not None:
                for item in compare(bench, bench.models[name], start, time, ours, allowed):
                    yield self._blamed(bench, name, time, item)

    def _blamed(self, bench: Bench, name: str, time: Array, item: Row | Series) -> Row | Series:
        """A row that fails with the term that is to blame, asked along the native motion."""
        if not isinstance(item, Row) or item.verdict != "fail":
            return item
        start = initial_state(bench.system, dict(self.position), dict(self.velocity))
        run = bench.models[NATIVE].simulate(*start, time[:: SAMPLES // 8])
        told = blamed(bench, name, run.position, run.velocity, np.zeros_like(run.velocity))
        if told.agree:
            told = Told("the accelerations agree, so it is the integration", {"term": "integration"}, agree=True)
        note = "; ".join(filter(None, [item.note, told.words]))
        return replace(item, note=note, first_divergence={**(item.first_divergence or {}), **told.place} or None)

    def _integrated(
        self, bench: Bench, model: EngineModel, start: tuple[Array, Array], time: Array, ours: Array, allowed: float
    ) -> Iterable[Row]:
        theirs = model.simulate(*start, time).position
        why = "its accelerations integrated to 1e-12 by steps that adapt; nothing corrects what opens meanwhile"
        apart, place = _apart(bench, time, ours, theirs, allowed)
        engines = (NATIVE, "pinocchio")
        yield bench.row(self.quantity, engines, apart, allowed, unit="rad", why=why, first_divergence=place)

    def _soft(
        self, bench: Bench, model: EngineModel, start: tuple[Array, Array], time: Array, ours: Array, allowed: float
    ) -> Iterable[Row | Series]:
        """MuJoCo's own constraints, stiffer and stiffer: what is left goes with their time constant."""
        soften = getattr(model, "soften", None)
        if soften is None:
            return
        found, place = [], None
        for constant, step in SOFT:
            soften(constant)
            apart, place = _apart(bench, time, ours, model.simulate(*start, time, step=step).position, allowed)
            found.append(apart)
        constants = [constant for constant, _ in SOFT]
        table = ", ".join(f"{1e3 * c:g} ms: {x:.1e}" for c, x in zip(constants, found, strict=True))
        yield bench.row(
            self.quantity,
            (NATIVE, "mujoco"),
            found[-1],
            allowed,
            unit="rad",
            why="MuJoCo's equality constraints are soft; what they leave goes with their time constant (solref)",
            note=f"the difference is MuJoCo's softness, by time constant {table}",
            first_divergence=place,
        )
        yield bench.row(
            "softness_goes",
            (NATIVE, "mujoco"),
            found[-1] / found[0] if found[0] > 0.0 else 0.0,
            0.1,
            why="what is softness goes as the constraint stiffens, what is an error of ours stays",
            note=f"from {found[0]:.1e} to {found[-1]:.1e} rad",
        )
        yield Series(
            bench.case.name,
            "convergence",
            "mujoco",
            tuple(constants),
            tuple(found),
            "time constant of MuJoCo's equality constraints [s]",
            "difference from the exact loop [rad]",
            title=bench.case.title,
            style="points",
            log="xy",
        )

    def _stepped(
        self, bench: Bench, model: EngineModel, start: tuple[Array, Array], time: Array, ours: Array, allowed: float
    ) -> Iterable[Row]:
        coarse, fine = (model.simulate(*start, time, step=step).position for step in STEPS)
        apart, place = _apart(bench, time, ours, (4.0 * fine - coarse) / 3.0, allowed)
        yield bench.row(
            self.quantity,
            (NATIVE, "exudyn"),
            apart,
            allowed,
            unit="rad",
            first_divergence=place,
            why="generalized-α with Lagrange multipliers, order two: its error at two steps taken out",
            note=f"at {1e3 * STEPS[1]:g} ms alone {np.abs(fine - ours).max():.1e}",
        )


def _apart(
    bench: Bench, time: Array, ours: Array, theirs: Array, allowed: float
) -> tuple[float, dict[str, object] | None]:
    """Largest difference of two motions, and when and how they leave what is allowed."""
    place = left_line(time, bench.system.position_names, ours, theirs, allowed)
    return float(np.abs(theirs - ours).max()), place


@dataclass(frozen=True)
class LoopsKept:
    """How far loops open over a run of the native engine: positions [m or rad] and velocities."""

    position: tuple[tuple[str, float], ...] = ()
    velocity: tuple[tuple[str, float], ...] = ()
    duration: float = 10.0
    allowed: float = 1e-10
    quantity: str = "loops_kept"

    def run(self, bench: Bench) -> Iterable[Row | Series]:
        model = getattr(bench.models.get(NATIVE), "model", None)
        if model is None:
            return
        start = initial_state(bench.system, dict(self.position), dict(self.velocity))
        run = model.simulate(*start, np.linspace(0.0, self.duration, 201))
        pairs = zip(run.position, run.velocity, strict=True)
        opened = [(np.abs(model.open_by(q)).max(), np.abs(model.loop_jacobian(q) @ v).max()) for q, v in pairs]
        worst = np.array(opened).max(axis=0)
        yield bench.row(
            self.quantity,
            (NATIVE, "analytic"),
            float(worst.max()),
            self.allowed,
            unit="rad",
            why="positions and velocities are projected after every step, until rounding is left",
            note=f"over {self.duration:g} s: positions {worst[0]:.1e}, velocities {worst[1]:.1e}",
            about={"term": "loops_kept"},
            source="what the loops state",
        )
