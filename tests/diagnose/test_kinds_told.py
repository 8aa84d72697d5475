"""What is certain of a kind where no law of it is."""

from __future__ import annotations

from types import SimpleNamespace

import pytest
from simulated_recordings import nominal

from harness.diagnose.answer import kinds_told
from harness.diagnose.answer.kinds_told import certain_dissipation
from harness.diagnose.problem.candidates import candidates
from harness.effects.catalogue import effect
from harness.errors import InputError


def sets(*rows: tuple[float, tuple[str, ...]]) -> list[tuple[float, SimpleNamespace]]:
    """Sets as they are weighed: a share and keys each."""
    out = []
    for share, keys in rows:
        pairs = [key.split("@") for key in keys]
        members = [SimpleNamespace(effect=effect(name), site=site) for name, site in pairs]
        out.append((share, SimpleNamespace(hypothesis=SimpleNamespace(members=members))))
    return out


OUTCOME = SimpleNamespace(
    evidence=object(), problem=SimpleNamespace(system=SimpleNamespace(joint_names=("hip", "knee")))
)
SPLIT = sets(
    (0.6, ("coulomb_friction@hip", "quadratic_drag@hip")),
    (0.38, ("viscous_damping@hip", "payload_mass@shank")),
    (0.02, ("viscous_damping@knee",)),
)


def test_laws_that_share_the_odds_make_their_kind_certain(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(kinds_told, "weighed", lambda *_, **__: SPLIT)
    told = certain_dissipation(OUTCOME, ())
    assert told.startswith("That what brakes hip is not as modelled is certain")
    assert "knee" not in told
    # Where one of them is told already, nothing is added.
    assert certain_dissipation(OUTCOME, ("hip",)) == ""
    # Without a force that is left out, laws stand or fall by themselves.
    assert certain_dissipation(SimpleNamespace(evidence=None), ()) == ""


def test_a_name_that_is_no_effect_is_refused() -> None:
    with pytest.raises(InputError, match="coulomb_friction"):
        candidates(nominal(), [], only=["coulomb"])
