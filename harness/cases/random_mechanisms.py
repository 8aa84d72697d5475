"""Random chains and trees with axes, offsets and bodies in general position, up to a thousand joints."""

from collections.abc import Callable
from functools import partial

from harness.cases.case import Case
from harness.cases.users import state_checks
from harness.system import System, random_chain, random_tree

SIZES = (2, 7, 20, 50, 200, 1000)
KINDS = (("chain", random_chain), ("tree", random_tree))


def _case(kind: str, draw: Callable[..., System], n: int) -> Case:
    return Case(
        name=f"{kind}_{n}",
        title=f"Random {kind} of {n} joints, revolute and prismatic, with armature and damping",
        source="agreement of independent engines at random states",
        system=partial(draw, n, seed=n, armature=True, damping=True),
        checks=state_checks(n, states=8 if n <= 200 else 2),
        group="scale",
        cost=1.0 if n <= 50 else 3.0 if n <= 200 else 20.0,
    )


WELDED = Case(
    name="welded_tree",
    title="Random tree of seven joints with links welded to others",
    source="agreement of independent engines at random states",
    system=partial(random_tree, 7, seed=17, fixed=0.4, armature=True, damping=True),
    checks=state_checks(7),
    group="scale",
)
CASES = (*(_case(kind, draw, n) for kind, draw in KINDS for n in SIZES), WELDED)
