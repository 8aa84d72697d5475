"""MJCF that can grow (replicas, attached models, grids, stated sizes) tried by MuJoCo in a process of its own first.

Of a few of them MuJoCo 4.0.0 does not come back, or takes the process with it: none of that is an error that a program could catch.
What MuJoCo merely refuses is told by the reader.
"""

from __future__ import annotations

import pickle
import signal
import subprocess
from collections.abc import Sequence
from pathlib import Path

from harness.errors import InputError
from harness.limited_process import command, environment

# Elements by which a short document becomes a large model.
GROWING = frozenset(("replicate", "attach", "model", "flexcomp", "composite", "size", "hfield"))
LONGEST = 60  # [s]
_START = "from harness.system.mjcf_trial_process import work; work()"


def try_apart(data: bytes, source: Path | None, allow: Sequence[Path]) -> None:
    """Let MuJoCo load a document in another process; InputError where that crashes or takes too long."""
    request = pickle.dumps((data, None if source is None else source.absolute(), [path.absolute() for path in allow]))
    try:
        status = subprocess.run(
            command(_START), input=request, capture_output=True, timeout=LONGEST, env=environment(), check=False
        ).returncode
    except subprocess.TimeoutExpired:
        raise InputError(
            f"MuJoCo does not load it within {LONGEST} s", mend="ask for fewer copies or smaller grids", source=source
        ) from None
    except OSError:  # no process may be started here
        return
    if status < 0:
        raise InputError(
            f"MuJoCo crashes on it ({signal.Signals(-status).name})",
            mend="take out, one after the other, what makes copies, grids or room",
            source=source,
        )
