"""All input is examined before the search; what an inner routine refuses after that is a mistake of ours, and told as one."""

from __future__ import annotations

import importlib
from dataclasses import replace
from typing import Any

import pytest
from simulated_recordings import Rig, nominal, releases

from harness.errors import InputError, UnsupportedError, unforeseen
from harness.system import Attachment

module = importlib.import_module("harness.diagnose.diagnose")


@pytest.mark.parametrize(("raised", "told"), [(InputError, RuntimeError), (UnsupportedError, UnsupportedError)])
def test_what_is_refused_in_the_search(
    monkeypatch: pytest.MonkeyPatch, raised: type[Exception], told: type[Exception]
) -> None:
    def refuse(*_: Any, **__: Any) -> None:
        raise raised("tau has shape (3, 1)")

    monkeypatch.setattr(module, "investigate", refuse)
    (run,) = releases(Rig(viscous=0.004), (0.4,), 1e-4, seed=5, duration=2.0, rate=50.0)
    with pytest.raises(told) as error:
        module.diagnose([run], nominal())
    assert type(error.value) is told
    if told is RuntimeError:
        assert unforeseen(error.value).startswith("a defect in denoc")
        assert "tau has shape (3, 1)" in str(error.value)


@pytest.mark.parametrize(("effect", "site"), [("sensor_gain", "pivot"), ("actuator_gain", "rod")])
def test_what_the_model_attaches_at_no_channel_or_joint_is_refused(effect: str, site: str) -> None:
    """It would do nothing, and the search would find again what the model says that it knows."""
    (run,) = releases(Rig(), (0.4,), 1e-4, seed=5, duration=2.0, rate=50.0)
    system = replace(nominal(), attachments=(Attachment(effect, site, {"gain": 1.1}),))
    with pytest.raises(InputError, match=f"there is no .* '{site}'"):
        module.diagnose([run], system)
