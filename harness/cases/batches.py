"""Many states at once, by each of the kernels that a mechanism can be given to, and short chains of hinges one by one."""

from collections.abc import Callable
from functools import partial

from harness.cases.beams import alternating_chain
from harness.cases.case import Case, Check
from harness.cases.checks.batch import BATCHES, BatchAgreement
from harness.cases.checks.batch_straight import BatchStraight
from harness.cases.users import state_checks
from harness.system import System, random_chain, random_tree
from harness.system.random_joints import floating_tree, free_of_a_link, in_space, spinning_freely

ENGINES = ("denoc", "pinocchio", "mujoco")


def _checks(allowed: float) -> tuple[Check, ...]:
    why = "rounding times the condition number, as for one state at a time"
    return tuple(BatchAgreement(of, allowed, why) for of in BATCHES)


def hinges(n: int) -> System:
    """A chain of hinges alone: from four to eight it has a kernel of its own for one state."""
    return random_chain(n, seed=40 + n, prismatic=0.0, armature=True, damping=True)


def floating() -> System:
    """A free body with joints of several degrees on it, as batches take it."""
    return spinning_freely(in_space())


def _batch(name: str, title: str, build: Callable[[], System], allowed: float) -> Case:
    return Case(
        name=f"batch_{name}",
        title=title,
        source="agreement of independent engines at random states",
        system=build,
        checks=_checks(allowed),
        group="scale",
        engines=ENGINES,
    )


CASES = (
    _batch("pendulum", "One joint, many states at once", partial(hinges, 1), 1e-12),
    _batch(
        "chain",
        "A chain with sliders, many states at once",
        partial(random_chain, 9, seed=49, prismatic=0.4, armature=True, damping=True),
        1e-11,
    ),
    _batch("hinges", "A chain of hinges, many states at once", partial(hinges, 6), 1e-11),
    _batch(
        "tree",
        "A tree with fixed joints and sliders, many states at once",
        partial(random_tree, 14, seed=50, prismatic=0.3, fixed=0.2, armature=True, damping=True),
        1e-11,
    ),
    _batch(
        "in_space",
        "What floats, with a ball and other joints on it, many states at once",
        lambda: spinning_freely(in_space()),
        1e-11,
    ),
    _batch("floating", "What floats, with hinges and slides alone on it, many states at once", floating_tree, 1e-11),
    _batch("loose", "A free joint between two links that move, many states at once", free_of_a_link, 1e-11),
    _batch("long", "Seventy joints, many states at once", partial(random_chain, 70, seed=51, prismatic=0.1), 1e-9),
    Case(
        name="batch_flexible",
        title="A chain of rigid and flexible links, many states at once, held straight",
        source="the integrals of a straight beam are those of a slender rod: engines of rigid bodies",
        system=partial(alternating_chain, 4, 2),
        checks=(
            BatchStraight("acceleration", 1e-10, "rounding times the condition number, which the beams' modes raise"),
            BatchStraight("inverse_dynamics", 1e-12, "rounding of double precision"),
            BatchStraight("mass_matrix", 1e-12, "rounding of double precision"),
        ),
        group="flexible",
        engines=ENGINES,
    ),
    *(
        Case(
            name=f"hinges_{n}",
            title=f"A chain of {n} hinges, by the kernel for short chains",
            source="agreement of independent engines at random states",
            system=partial(hinges, n),
            checks=state_checks(n, states=4),
            group="scale",
            engines=ENGINES,
        )
        for n in (4, 5, 8)
    ),
)
