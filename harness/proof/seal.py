"""Sealing: the answers are written apart and their digests published before any diagnosis starts.

Layout of a proof in ``out``: ``cases/<name>/`` holds model and recordings, all that the diagnosing process is given;
``digests.json`` maps every case to the SHA-256 of its sealed answer; ``sealed/<name>.json`` holds the answer with a random
salt, so that the digest cannot be guessed from a list of effects; ``found/<name>.json`` is what diagnosis said.
"""

from __future__ import annotations

import hashlib
import json
import secrets
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from harness.errors import InputError
from harness.proof.draw import Case
from harness.proof.visibility import DETECTION_LIMIT
from harness.whole_files import write_whole

Array = NDArray[np.float64]


def answer(case: Case, noise_free: Mapping[str, Mapping[str, Array]] | None = None) -> dict[str, Any]:
    """The answer of a case as plain data; noise_free: columns of its recordings by run, to be sealed with it."""
    columns = {
        run: {name: [float(f"{x:.9g}") for x in values] for name, values in data.items()}
        for run, data in (noise_free or {}).items()
    }
    return {
        **({"noise_free": columns} if columns else {}),
        "kind": case.kind,
        "planted": [{"effect": p.effect, "site": p.site, "parameters": dict(p.parameters)} for p in case.planted],
        "visibility": list(case.visibility),
        "detection_limit": DETECTION_LIMIT,
        "joints": list(case.rig.joints),
        "noise_std": case.scene.sensor.std,
        "quantisation": case.scene.sensor.step,
        "colour": case.scene.sensor.colour,
        "rate": case.scene.sensor.rate,
    }


def digest(text: str) -> str:
    """SHA-256 of a sealed answer."""
    return hashlib.sha256(text.encode("utf-8")).hexdigest()


def seal(case: Case, folder: Path, noise_free: Mapping[str, Mapping[str, Array]] | None = None) -> str:
    """Write the sealed answer and return its digest."""
    text = json.dumps({"salt": secrets.token_hex(16), **answer(case, noise_free)}, indent=1)
    write_whole(folder / f"{case.name}.json", text)
    return digest(text)


def unseal(name: str, folder: Path, published: str) -> dict[str, Any]:
    """The answer of a case; InputError if it is not the one whose digest was published."""
    path = folder / f"{name}.json"
    try:
        text = path.read_text(encoding="utf-8")
    except FileNotFoundError:
        raise InputError(
            "the sealed answer is gone",
            source=path,
            mend="restore it from a copy of the folder, or run the proof afresh",
        ) from None
    except UnicodeDecodeError:
        text = ""
    if digest(text) != published:
        raise InputError(
            "the sealed answer was changed after its digest was published", source=path, mend="run the proof afresh"
        )
    return json.loads(text)
