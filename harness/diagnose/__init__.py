"""Locate a mismatch, name the physics left out, fit it, select, explain, propose the next experiment.

``harness.diagnose`` is both this package and, called, the diagnosis itself, whatever was imported first.
"""

import sys
from types import ModuleType
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from harness.diagnose.diagnose import diagnose


class _CallableModule(ModuleType):
    """A package that can be called like its main function."""

    def __call__(self, *args: Any, **options: Any) -> Any:
        from harness.diagnose.diagnose import diagnose

        return diagnose(*args, **options)


def __getattr__(name: str) -> Any:
    if name == "diagnose":
        return sys.modules[__name__]
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")


sys.modules[__name__].__class__ = _CallableModule

__all__ = ["diagnose"]
