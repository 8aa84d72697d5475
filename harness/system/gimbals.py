"""What is lost of gimbals where a format has none."""

from __future__ import annotations

from harness.errors import UnsupportedError
from harness.system.description import System


def without_gimbals(system: System, form: str) -> list[str]:
    """What a format without gimbals leaves out, a line each.

    Raises UnsupportedError where a gimbal resists: left out, that would make another mechanism of it, and at the three joints it
    is another law.
    """
    for gimbal in system.gimbals:
        resists = [
            f"{what} {size:g}" for what, size in (("damping", gimbal.damping), ("friction", gimbal.friction)) if size
        ]
        if resists:
            of = "the velocity" if gimbal.slides else "the angular velocity"
            raise UnsupportedError(
                f"gimbal {gimbal.name!r} has {' and '.join(resists)} against {of} of three joints, which {form} cannot say",
                mend="write TOML, or the system before its balls were taken apart",
                source=system.source,
            )
    return [
        f"gimbal {gimbal.name!r}: that {', '.join(gimbal.coordinates)} belong together" for gimbal in system.gimbals
    ]
