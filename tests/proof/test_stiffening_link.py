"""A link that stiffens as it turns is named where the model keeps it from doing so.

It is there or it is not. The model without it is bent to do its work, and from there its slope leads nowhere, so that it was never
found among what has sizes. The truth is Exudyn's: its cable elements always stiffen.
"""

from __future__ import annotations

from pathlib import Path

from one_concealed import told_of

SEED = 70214


def test_geometric_stiffening_is_named(tmp_path: Path) -> None:
    found = told_of("geometric_stiffening", "flexible single", SEED, tmp_path)
    assert found["verdict"] == "explained"
    assert [(f["effect"], f["site"]) for f in found["findings"]] == [("geometric_stiffening", "strip")]
