"""A diagnosis as files."""

from __future__ import annotations

import json
from pathlib import Path
from typing import TYPE_CHECKING

from harness.errors import InputError
from harness.report.files import staged, write_folder

if TYPE_CHECKING:
    from harness.diagnose.diagnosis import Diagnosis


def write_diagnosis(found: Diagnosis, folder: str | Path) -> list[Path]:
    """Write ``diagnosis.json``, ``report.html`` and the augmented model (``augmented.toml``); returns their paths."""
    from harness.report.diagnosis.page import diagnosis_html
    from harness.system.write import write

    document = found.to_json()
    text = json.dumps(document, indent=1, ensure_ascii=False, allow_nan=False) + "\n"
    written = write_folder(folder, {"diagnosis.json": text, "report.html": diagnosis_html(document, found.curves)})
    if found.augmented is not None:
        target = Path(folder) / "augmented.toml"
        try:
            with staged(target) as temporary:
                write(found.augmented, temporary)
        except InputError as error:
            raise InputError(f"the augmented model: {error.what}", source=target, mend=error.mend) from error
        written.append(target)
    return written
