"""The process that reads foreign binary formats for ``harness.recording.formats.apart``: a request a line, answers in bytes."""

from __future__ import annotations

import json
import os
import signal
import sys
from importlib import import_module
from pathlib import Path
from typing import Any, BinaryIO

import numpy as np

from harness.errors import InputError, MissingPackageError, UnsupportedError
from harness.limited_process import limit
from harness.recording.formats.apart import AGAIN, KINDS
from harness.recording.formats.table import Table

LONGEST = 300  # letters of what a library says


def work() -> None:
    """Answer requests from standard input until it ends."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # Ctrl-C is the other process's to handle: this one ends with its pipe
    # What libraries print is for nobody.
    answers = os.fdopen(os.dup(1), "wb")
    nowhere = os.open(os.devnull, os.O_WRONLY)
    os.dup2(nowhere, 1)
    for line in sys.stdin.buffer:
        request = json.loads(line)
        # Of processor time, should nobody be there any more to end it.
        limit(request["memory"], request["seconds"])
        _send(answers, *_answer(request))


def _answer(request: dict[str, Any]) -> tuple[dict[str, Any], list[bytes]]:
    path, module = Path(request["path"]), request["module"]
    try:
        read = getattr(import_module(f"harness.recording.formats.{module}"), request["reader"])
        return _packed(read(path, Path(request["file"])))
    except MissingPackageError as absent:
        told: dict[str, Any] = {"package": absent.package, "extra": absent.extra}
        return {"error": told | {"what": absent.need, "source": absent.source}}, []
    except InputError as fault:
        told = {name: getattr(fault, name) for name in ("what", "mend", "line", "column")}
        return {"error": told | {"unsupported": isinstance(fault, UnsupportedError)}}, []
    except MemoryError:
        what = f"reading it needs more than {request['memory'] / 2**30:.3g} GiB of memory"
        mend = "give a shorter recording, or fewer columns"
    except RecursionError:
        what, mend = f"damaged {KINDS[module]}: it is nested too deeply", AGAIN.get(module, "write it again")
    except Exception as failure:  # of damaged files libraries raise whatever their last line raised
        said = f"{failure}"[:LONGEST] or type(failure).__name__
        what, mend = f"damaged {KINDS[module]}: {said}", AGAIN.get(module, "write it again")
    return {"error": {"what": what, "mend": mend, "line": None, "column": None, "unsupported": False}}, []


def _packed(table: Table) -> tuple[dict[str, Any], list[bytes]]:
    head = {
        "columns": [(name, len(values)) for name, values in table.columns.items()],
        "units": dict(table.units),
        "origins": dict(table.origins),
        "aliases": dict(table.aliases),
        "interleaved": table.interleaved,
        "faults": {name: (fault.what, fault.mend) for name, fault in table.faults.items()},
        "notes": [vars(note) for note in table.notes],
    }
    return head, [np.ascontiguousarray(values, dtype=np.float64).tobytes() for values in table.columns.values()]


def _send(answers: BinaryIO, head: dict[str, Any], numbers: list[bytes]) -> None:
    text = json.dumps(head, default=_plain).encode()
    answers.write(f"{len(text)} {sum(map(len, numbers))}\n".encode())
    answers.write(text)
    answers.writelines(numbers)
    answers.flush()


def _plain(value: Any) -> Any:
    """Numbers of NumPy as Python's."""
    return value.item() if isinstance(value, np.generic) else str(value)
