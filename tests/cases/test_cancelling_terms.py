"""Forces that vanish because their terms cancel are compared against the terms, not against what is left of them."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from harness.cases.case import Case
from harness.cases.run import run_case
from harness.cases.users import state_checks
from harness.compare.scales import terms
from harness.engines import registry
from harness.system import System
from harness.system.description import constant
from harness.system.random_systems import SPECIAL, special_chain

ENGINES = ("denoc", "pinocchio", "mujoco", "exudyn")


def rows(system: System) -> list:
    case = Case(system.name, system.name, "test", lambda: system, state_checks(len(system.joint_names)), group="models")
    return list(run_case(case, {name: registry.engine(name) for name in ENGINES}).rows)


@pytest.mark.parametrize("kind", SPECIAL)
@pytest.mark.parametrize("n", [1, 3, 6])
def test_engines_agree_where_forces_vanish(kind: str, n: int) -> None:
    for seed in range(3):
        found = rows(special_chain(kind, n, seed))
        assert not [row for row in found if row.verdict == "fail"], seed
        assert sum(row.verdict == "pass" for row in found) >= 15


@pytest.mark.parametrize("kind", SPECIAL)
def test_a_wrong_centre_of_mass_is_still_seen(kind: str) -> None:
    """An error of a nanometre, in one engine alone, is far above what is allowed for forces or inertias."""
    system = special_chain(kind, 3, 1)
    link = system.links[1]
    moved = system.replace_link(replace(link, com=constant(link.com + np.array([1e-9, 2e-9, -1e-9]))))

    class Wrong:
        name = "wrong"

        def version(self) -> str:
            return "0"

        def refuses(self, _: System) -> None:
            return None

        def build(self, _: System) -> object:
            return registry.engine("mujoco").build(moved)

    case = Case(kind, kind, "test", lambda: system, state_checks(3), group="models")
    found = run_case(case, {"denoc": registry.engine("denoc"), "wrong": Wrong()}).rows
    assert any(row.verdict == "fail" for row in found)


def test_terms_of_a_turntable() -> None:
    """1.5 kg at 0.1 m beside and 0.05 m above a vertical axis: weight times arm is what its gravity torque cancels from."""
    base = special_chain("vertical", 1, 0)
    joint = replace(base.joints[0], xyz=constant(np.zeros(3)))
    link = replace(
        base.links[0], mass=1.5, com=constant([0.1, 0.0, 0.05]), inertia=constant(np.diag([0.02, 0.02, 0.03]))
    )
    found = terms(replace(base, joints=(joint,), links=(link,)), np.array([0.3]), np.array([2.0]))
    arm = np.hypot(0.1, 0.05)
    assert found.gravity[0] == pytest.approx(1.5 * 9.81 * arm, rel=1e-12)
    assert found.potential == pytest.approx(1.5 * 9.81 * arm, rel=1e-12)
    # Centripetal 2² · 0.1 m/s², its two terms 2² · arm, and the tensor's own turning.
    inertia = np.sqrt(0.02**2 + 0.02**2 + 0.03**2)
    assert found.motion[0] == pytest.approx(1.5 * (0.4 + 4.0 * arm) * arm + 4.0 * inertia, rel=1e-12)
