"""The pytest plugin (entry point ``denoc``): a marker for tests of dynamics, and fixtures for them."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pytest

if TYPE_CHECKING:
    from harness.cases.results import Results
    from harness.denoc import Denoc
    from harness.system import System

_MARKER = "dynamics(*models): a test of dynamics, run once for each model file (relative to the test's folder)"


def pytest_configure(config: pytest.Config) -> None:
    """Make the marker known."""
    config.addinivalue_line("markers", _MARKER)


def pytest_generate_tests(metafunc: pytest.Metafunc) -> None:
    """Run a test once for each model of its marker."""
    mark = metafunc.definition.get_closest_marker("dynamics")
    models = [metafunc.definition.path.parent / model for model in mark.args] if mark is not None else []
    if models and {"dynamics_model", "dynamics_agree"} & set(metafunc.fixturenames):
        if "dynamics_model" not in metafunc.fixturenames:
            metafunc.fixturenames.append("dynamics_model")  # asked for by ``dynamics_agree`` only when it is called
        metafunc.parametrize("dynamics_model", models, ids=[path.name for path in models], scope="session")


@pytest.fixture(scope="session")
def dynamics_model(request: pytest.FixtureRequest) -> Path:
    """Path of the model that the marker ``dynamics`` names."""
    found: Path | None = getattr(request, "param", None)
    if found is None:
        raise pytest.UsageError("mark the test with the models: @pytest.mark.dynamics('robot.urdf')")
    return found


@pytest.fixture(scope="session")
def dynamics_system(dynamics_model: Path) -> System:
    """The mechanism of that model."""
    from harness.system import load

    return load(dynamics_model)


@pytest.fixture
def native_dynamics(dynamics_system: System) -> Denoc:
    """Its native dynamics, to hold one's own against by hand."""
    from harness.denoc import Denoc

    return Denoc(dynamics_system)


@pytest.fixture
def dynamics_agree(request: pytest.FixtureRequest) -> Callable[..., Results]:
    """``assert_dynamics_agree`` for the marker's model (or one that is given), with the figures kept in JUnit XML."""

    def check(engine: Any, model: str | Path | System | None = None, **options: Any) -> Results:
        from harness.testing.agree import assert_dynamics_agree

        __tracebackhide__ = True
        results = assert_dynamics_agree(
            engine, request.getfixturevalue("dynamics_model") if model is None else model, **options
        )
        for row in results.rows:
            if row.difference is not None:
                name = f"{row.quantity} [{'+'.join(row.engines)}]"
                # As `record_property` does, without its warning about one flavour of JUnit XML.
                request.node.user_properties.append((name, f"{row.difference:.2e}"))
        return results

    return check
