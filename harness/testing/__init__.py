"""For the tests of other projects: engines held against one another by pytest.

The names below are imported when first used: pytest loads its plugins before it knows whether they are needed.
"""

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from harness.testing.agree import assert_dynamics_agree

__all__ = ["assert_dynamics_agree"]


def __getattr__(name: str) -> Any:
    if name == "assert_dynamics_agree":
        from harness.testing.agree import assert_dynamics_agree

        return assert_dynamics_agree
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
