"""Which readers there are for a file, and which of them is its format's own."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from pathlib import Path

from harness.engines.readers.reading import Reading
from harness.errors import InputError, UnsupportedError
from harness.system import System
from harness.system.xml_source import parse_xml

# Root element of a file to the engine that reads it as its format means: urdfdom by way of Pinocchio, and MuJoCo itself.
OWN = {"robot": "pinocchio", "mujoco": "mujoco"}


def root_of(path: Path) -> str:
    """``robot``, ``mujoco``, or nothing for a file that is neither."""
    try:
        data = path.read_bytes()
        return str(parse_xml(data, path).tag) if data.lstrip(b"\xef\xbb\xbf \t\r\n").startswith(b"<") else ""
    except (OSError, InputError):
        return ""


def floating_among(paths: Iterable[Path]) -> set[Path]:
    """Of files whose roots shall float those that are read so: URDF, where there is any; the others say themselves what floats."""
    every = set(paths)
    return {path for path in every if root_of(path) == "robot"} or every


def readers_of(path: Path) -> tuple[str, ...]:
    """Engines that can be asked to read the file by themselves, its format's own first; none for TOML."""
    own = OWN.get(root_of(path))
    if own is None:
        return ()
    return (own, *(name for name in ("pinocchio", "mujoco") if name != own))


def read_by(engine: str, path: Path, system: System, *, allow: Sequence[Path] = ()) -> Reading:
    """The file as that engine reads it, joints in the order of our system.

    Raises UnsupportedError with the reason where it refuses the file or has other joints, EngineUnavailableError.
    """
    if engine == "pinocchio":
        from harness.engines.readers.pinocchio import read_by_pinocchio

        return read_by_pinocchio(path, system, mjcf=root_of(path) == "mujoco")
    if engine == "mujoco":
        from harness.engines.readers.mujoco import read_by_mujoco

        return read_by_mujoco(path, system, allow=allow)
    raise UnsupportedError(f"{engine} has no reader of its own")
