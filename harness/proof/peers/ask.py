"""What peers say of the same cases, and how often they are right.

Each is given what a user would give it: the nominal model, the recordings, and the parameters that a user would
free. What counts as a claim is said by each.
"""

from __future__ import annotations

import json
import time
import tomllib
from collections.abc import Callable, Sequence
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from harness.errors import missing_package
from harness.parallel import parallel_map
from harness.proof.claims import score_claims, tally
from harness.proof.concealments import CONCEALMENTS
from harness.proof.kept import read_claimed, read_digests, read_found
from harness.proof.peers.figaroh import figaroh_claims
from harness.proof.peers.greedy import greedy_claims
from harness.proof.peers.practitioner import practitioner_claims
from harness.proof.peers.regression import regression_claims
from harness.proof.peers.runs import NotForIt
from harness.proof.peers.servo_friction import servo_claims
from harness.proof.peers.sysid import sysid_claims
from harness.proof.score import CaseScore
from harness.proof.seal import unseal
from harness.whole_files import write_whole

OURS = "denoc"
PEERS: dict[str, Callable[[Path], dict[str, Any]]] = {
    "mujoco.sysid": sysid_claims,
    "practitioner": practitioner_claims,
    "BAM's ladder": servo_claims,
    "FIGAROH": figaroh_claims,
    "greedy forward selection": greedy_claims,
    "pysindy": regression_claims,
}


def ask(folder: Path, peer: str) -> dict[str, Any]:
    """One peer on one case; what goes wrong is an answer too."""
    began = time.perf_counter()
    try:
        return {**PEERS[peer](folder), "seconds": round(time.perf_counter() - began, 1)}
    except ImportError as error:
        return {"skipped": str(missing_package(error) or f"not installed: {error}")}
    except NotForIt as error:
        return {"skipped": str(error)}
    except Exception as error:  # a peer may fail in any way; the proof says so and goes on
        return {"error": f"{type(error).__name__}: {error}"}


def to_ask(scores: Sequence[CaseScore], most: int) -> list[CaseScore]:
    """Cases that peers are asked about: clean ones, half of ``most`` at most, then single effects, all in the order of
    the draw.

    What a model states as an effect cannot be handed to them, nor can links that bend.
    """
    scores = [s for s in scores if not s.name.startswith("flexible")]
    single = [s for s in scores if s.kind == "single" and not CONCEALMENTS[s.planted[0][0]].stated]
    clean = [s for s in scores if s.kind == "clean"]
    kept = clean[: max(most // 2, most - len(single))]
    return kept + single[: most - len(kept)]


def compare_peers(
    out: Path,
    scores: Sequence[CaseScore],
    *,
    workers: int | None = None,
    dask: str | None = None,
    progress: Callable[[str, int, int], None] | None = None,
    most: int = 40,
) -> dict[str, Any]:
    """What each peer claims on clean cases and on those with one effect, a ``tally`` each; the diagnosis itself beside them.

    most: cases asked of each peer, see ``to_ask``.
    """
    chosen = to_ask([s for s in scores if not _stated(out / "cases" / s.name)], most)
    digests = read_digests(out)
    result: dict[str, Any] = {}
    found = {s.name: own(out, s.name) for s in chosen}
    for peer in PEERS:
        saved = out / "peers" / f"{peer.replace(' ', '_')}.json"
        said = read_claimed(saved) if saved.exists() else {}
        missing = [s.name for s in chosen if s.name not in said]
        if missing:
            count = len(chosen) - len(missing)

            def tick(
                index: int,
                found: dict[str, Any],
                *,
                peer: str = peer,
                saved: Path = saved,
                said: dict[str, Any] = said,
                missing: Sequence[str] = missing,
            ) -> None:
                nonlocal count
                count += 1
                said[missing[index]] = found
                _save(saved, peer, said)
                if progress is not None:
                    progress(peer, count, len(chosen))

            parallel_map(
                partial(ask, peer=peer),
                [out / "cases" / name for name in missing],
                workers=workers,
                dask=dask,
                done=tick,
            )
        # Answers are opened only now that everything has been said.
        answers = {s.name: unseal(s.name, out / "sealed", digests[s.name]) for s in chosen}
        asked = {name: what for name, what in said.items() if name in answers}
        result.setdefault(OURS, tally(list(chosen), found, answers))
        result[peer] = tally(score_claims(asked, answers), asked, answers)
    return result


def _stated(folder: Path) -> bool:
    """Whether a case's model states an effect."""
    return bool(tomllib.loads((folder / "model.toml").read_text(encoding="utf-8")).get("effect"))


def own(out: Path, name: str) -> dict[str, Any]:
    """What was found of a case, as far as a tally asks for it beside its score: error held out [rad] and seconds."""
    found = read_found(out, name)
    errors = [row["augmented"]["heldout_rmse"] for row in found.get("fit", ()) if row["channel"].endswith(".position")]
    known = [e for e in errors if e is not None]
    return {
        "heldout_rmse": float(np.sqrt(np.mean(np.square(known)))) if known else None,
        "seconds": found.get("seconds"),
    }


def _save(path: Path, peer: str, said: dict[str, Any]) -> None:
    """Whole or not at all, after every case: each takes minutes."""
    write_whole(path, json.dumps({"schema": "denoc.claims/1", "entrant": peer, "cases": said}, indent=1))
