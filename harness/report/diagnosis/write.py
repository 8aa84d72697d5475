"""A diagnosis as files."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING

from harness.errors import InputError
from harness.whole_files import staged, write_folder

if TYPE_CHECKING:
    from harness.diagnose.answer.diagnosis import Diagnosis
    from harness.system import System


FORCE = "predictive_force.py"
MODELS = ("augmented.toml", "augmented.urdf", "augmented.xml", "levelled.toml", "predictive.toml", FORCE)


def write_diagnosis(
    found: Diagnosis, folder: str | Path, *, said: Callable[[str], None] = lambda line: None
) -> list[Path]:
    """Write ``diagnosis.json``, ``report.html`` and the augmented model; returns their paths.

    The model is ``augmented.toml``, and ``augmented.urdf`` and ``augmented.xml`` (MJCF) as far as these can say it; ``said`` is
    told what they leave out. Where dry friction differs from recording to recording, the model at the last training
    recording's level is ``levelled.toml``. Where a force is left out, the model that predicts best is ``predictive.toml``, and
    a force without a name that acts in it is ``predictive_force.py``, for ``denoc simulate --effects``.
    """
    from harness.report.diagnosis.page import diagnosis_html

    document = found.to_json()
    text = json.dumps(document, indent=1, ensure_ascii=False, allow_nan=False) + "\n"
    page = diagnosis_html(document, found.curves, found.augmented, found.unnamed_force)
    texts = {"diagnosis.json": text, "report.html": page}
    if found.unnamed_force is not None:
        texts[FORCE] = found.unnamed_force.text(FORCE)
    written = write_folder(folder, texts)
    for model, name in ((found.augmented, "augmented"), (found.levelled, "levelled"), (found.predictive, "predictive")):
        if model is None:
            continue
        target = Path(folder) / f"{name}.toml"
        try:
            _write_model(model, target)
        except InputError as error:
            raise InputError(f"the {name} model: {error.what}", source=target, mend=error.mend) from error
        written.append(target)
    if found.augmented is not None and found.findings:
        written += _in_other_words(found.augmented, Path(folder), said)
    # Models of an earlier diagnosis in the same folder would be taken for this one's.
    for name in MODELS:
        if Path(folder) / name not in written:
            (Path(folder) / name).unlink(missing_ok=True)
    return written


def _in_other_words(model: System, folder: Path, said: Callable[[str], None]) -> list[Path]:
    """The model in formats that do not know effects, as far as their own words go."""
    from harness.engines.expressed import described

    written = []
    for ending in (".urdf", ".xml"):
        target = folder / f"augmented{ending}"
        try:
            left_out = _write_model(described(model), target)
        except InputError as error:
            said(f"no {target.name}: {error.what}")
            continue
        for line in left_out:
            said(f"{target.name} leaves out {line}")
        written.append(target)
    return written


def _write_model(model: System, target: Path) -> tuple[str, ...]:
    from harness.system.write import write

    with staged(target) as temporary:
        return write(model, temporary)
