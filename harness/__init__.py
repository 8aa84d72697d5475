"""DeNOC multibody dynamics, a harness that checks it against other engines, and diagnosis of what a model left out.

The names below are imported when first used, so that ``denoc --help`` starts quickly.
"""

from importlib import import_module
from typing import TYPE_CHECKING, Any

from harness.version import __version__

_HOME = {
    "System": "harness.system",
    "load": "harness.system",
    "Denoc": "harness.denoc",
    "diagnose": "harness.diagnose",
    "diagnose_fleet": "harness.fleet",
    "validate": "harness.cases",
    "InputError": "harness.errors",
}
__all__ = ["Denoc", "InputError", "System", "__version__", "diagnose", "diagnose_fleet", "load", "validate"]

if TYPE_CHECKING:
    from harness.cases import validate
    from harness.denoc import Denoc
    from harness.diagnose import diagnose
    from harness.errors import InputError
    from harness.fleet import diagnose_fleet
    from harness.system import System, load


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})


def __getattr__(name: str) -> Any:
    if name in _HOME:
        value = getattr(import_module(_HOME[name]), name)
        # The function, not the sub-package of the same name, is what `harness.diagnose` and the like mean.
        globals()[name] = value
        return value
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
