"""The documentation site builds without a complaint and asks for nothing from a server."""

from __future__ import annotations

import re
import subprocess
import sys
from pathlib import Path

import pytest

pytest.importorskip("mkdocs", reason="mkdocs is not installed")
pytest.importorskip("mkdocstrings", reason="mkdocstrings is not installed")

ROOT = Path(__file__).parents[2]


@pytest.mark.slow
def test_the_site_is_built_whole_and_stands_alone(tmp_path):
    # Strict: a link that leads nowhere, a page that no menu has, an object that the reference cannot find.
    command = [sys.executable, "-m", "mkdocs", "build", "--strict", "--quiet", "--site-dir", str(tmp_path / "site")]
    built = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=False)
    assert built.returncode == 0, built.stdout + built.stderr
    site = tmp_path / "site"
    pages = sorted(path.name for path in site.glob("*.html"))
    assert {"tutorial.html", "troubleshooting.html", "glossary.html", "own.html", "api.html", "404.html"} <= set(pages)
    for page in pages:
        text = (site / page).read_text(encoding="utf-8")
        # From disk a path from the root leads nowhere.
        assert re.findall(r"""<[^>]+(?:src|href)=["']?/[^"' >]*""", text) == [], page
        assert re.findall(r"""<(?:script|img|link)[^>]+(?:src|href)=["']?https?://[^"' >]+""", text) == []
        assert "unpkg.com/iframe" not in text
    reference = (site / "api.html").read_text(encoding="utf-8")
    for name in ("forward_dynamics", "mass_matrix", "to_frame", "read_recording", "InputError"):
        assert name in reference
    assert len(list((site / "schemas").glob("*.json"))) == len(list((ROOT / "docs" / "schemas").glob("*.json")))
