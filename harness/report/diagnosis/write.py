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
    """Write ``diagnosis.json``, ``report.html`` and the augmented model (``augmented.toml``); returns their paths.

    Where dry friction differs from recording to recording, the model at the last training recording's level is ``levelled.toml``.
    """
    from harness.report.diagnosis.page import diagnosis_html
    from harness.system.write import write

    document = found.to_json()
    text = json.dumps(document, indent=1, ensure_ascii=False, allow_nan=False) + "\n"
    written = write_folder(folder, {"diagnosis.json": text, "report.html": diagnosis_html(document, found.curves)})
    for model, name in ((found.augmented, "augmented"), (found.levelled, "levelled")):
        if model is None:
            continue
        target = Path(folder) / f"{name}.toml"
        try:
            with staged(target) as temporary:
                write(model, temporary)
        except InputError as error:
            raise InputError(f"the {name} model: {error.what}", source=target, mend=error.mend) from error
        written.append(target)
    return written
