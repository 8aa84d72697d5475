"""Systems to files: the project's TOML says all, URDF and MJCF what they can."""

from __future__ import annotations

import os
from pathlib import Path
from tempfile import NamedTemporaryFile

from harness.errors import InputError, unwritable
from harness.system.description import System
from harness.system.write_mjcf import to_mjcf
from harness.system.write_toml import to_toml
from harness.system.write_urdf import to_urdf

_WRITERS = {".toml": to_toml, ".urdf": to_urdf, ".xml": to_mjcf, ".mjcf": to_mjcf}


def write(system: System, path: str | Path) -> tuple[str, ...]:
    """Write a system as TOML, URDF or MJCF, by the ending .toml, .urdf or .xml; the file appears whole or not at all.

    Returns what the format cannot say and the file therefore leaves out, one line each (nothing for TOML).
    Raises InputError for an unknown ending or a folder that is not there, UnsupportedError where leaving out would
    make another mechanism of it.
    """
    target = Path(path)
    writer = _WRITERS.get(target.suffix.lower())
    if writer is None:
        raise InputError(
            f"no format for the ending {target.suffix!r}", mend="end it in .toml, .urdf or .xml", source=target
        )
    text, left_out = writer(system)
    temporary = None
    try:
        with NamedTemporaryFile("w", encoding="utf-8", dir=target.parent, suffix=target.suffix, delete=False) as file:
            temporary = Path(file.name)
            file.write(text)
        # A temporary file is private to its owner; the model gets the rights that a plainly written file has.
        mask = os.umask(0)
        os.umask(mask)
        temporary.chmod(0o666 & ~mask)
        temporary.replace(target)
    except OSError as error:
        if temporary is not None:
            temporary.unlink(missing_ok=True)
        raise unwritable(target, error) from None
    return left_out
