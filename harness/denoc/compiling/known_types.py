"""What numba found out about an operator once is not worked out again, which saves a third of all compiling.

For every use of ``+``, ``*``, ``abs`` … numba asks all templates that were ever registered for that function, arrays,
strings and lists among them, until one fits the arguments' types. Kernels that are long rows of formulas spend much of
their compilation there, always with the same few types. The answer depends on the function, its templates and the types
alone: another template makes another function object, so that nothing known goes stale. The code that comes out is the same.

And most of what it asks ends in an error that nobody sees, whose text it marks up for a terminal that it prepares anew each
time (where colorama is installed): a tenth of all compiling.
"""

from __future__ import annotations

import contextlib
import functools
import inspect
from typing import Any

from numba.core import errors
from numba.core.types import functions

_EXPECTED = ["self", "context", "args", "kws"]


@functools.cache
def remember() -> bool:
    """Let numba remember signatures from now on in this process; False if this numba is built otherwise, and left as it is."""
    kind: Any = getattr(functions, "BaseFunction", None)
    ask = getattr(kind, "get_call_type", None)
    if ask is None or list(inspect.signature(ask).parameters) != _EXPECTED:
        return False
    if hasattr(errors, "ColorShell"):
        # Marks in texts stay; a terminal of today shows them unprepared.
        errors.ColorShell = contextlib.nullcontext
    # By identity; the function is kept, so that its identity is not given to another.
    known: dict[tuple[int, int, Any], tuple[Any, Any]] = {}

    @functools.wraps(ask)
    def get_call_type(self: Any, context: Any, args: Any, kws: Any) -> Any:
        if kws:
            return ask(self, context, args, kws)
        key = (id(self), id(context), args)
        found = known.get(key)
        if found is None:
            found = known[key] = self, ask(self, context, args, kws)
        return found[1]

    kind.get_call_type = get_call_type
    return True
