"""``denoc prove``: the blind proof."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING

import click

from harness.cli.interrupt import Interrupted
from harness.cli.options import console, output_options, progress, wide_options, write_json
from harness.whole_files import nothing_in, write_whole

if TYPE_CHECKING:
    from harness.proof.run import Proof


@click.command()
@click.option("--quick", is_flag=True, help="40 cases of short recordings instead of the full proof's 400 and more.")
@click.option("--cases", type=click.IntRange(min=1), metavar="N", help="About so many cases, in the full proof's mix.")
@click.option(
    "--seed", type=click.IntRange(min=0), metavar="N", help="Draw the cases from this seed; default: a fresh one."
)
@click.option("--resume", metavar="DIR", help="Go on with an interrupted proof in its folder.")
@click.option("--score", metavar="DIR", help="Only score what has been diagnosed so far of the proof in its folder.")
@click.option(
    "--claims",
    metavar="FILE",
    help="With --score: score what another tool claims of the cases in the proof's folder (denoc.claims/1).",
)
@click.option(
    "--export",
    metavar="DIR",
    help="Conceal only, and write the cases for others into DIR: recordings, nominal models, digests, how to enter; no answers.",
)
@click.option(
    "--peers/--no-peers",
    default=None,
    help="Ask other methods about the same cases; default: in the full proof, where the extra [peers] is installed.",
)
@output_options("Folder of the proof: cases, sealed answers, digests, answers found, proof.json; default: denoc-proof.")
@wide_options()
def prove(
    quick: bool,
    cases: int | None,
    seed: int | None,
    resume: str | None,
    score: str | None,
    claims: str | None,
    export: str | None,
    peers: bool | None,
    out: Path | None,
    json_file: str | None,
    workers: int | None,
    dask: str | None,
) -> int:
    """Conceal effects in recordings made by other engines, diagnose them without the answers, score the result.

    The answers are sealed before the diagnosis starts: proof folder and digests are written first, so that anyone can
    check that they were not changed.

    \b
    Examples:
      denoc prove --quick
      denoc prove --seed 7 --out proof7 --dask tcp://head:8786
      denoc prove --score proof7
      denoc prove --quick --out kept --export cases
      denoc prove --score kept --claims claims.json
    """
    from harness.errors import InputError
    from harness.proof.run import FULL, QUICK, scaled, score_of_claims, score_so_far
    from harness.proof.run import prove as run

    if quick and cases is not None:
        raise InputError("--quick and --cases do not go together", mend="give the one or the other")
    if claims is not None and score is None:
        raise InputError("--claims needs the folder that has the answers", mend="give --score DIR --claims FILE")
    if score is not None:
        if quick or any(option is not None for option in (cases, seed, peers, resume, out, export)):
            raise InputError(
                "--score goes with none of the options that say what to prove",
                mend="give --score DIR alone, or with --claims FILE",
            )
        if claims is not None:
            _tell(
                score_of_claims(Path(score), Path(claims)), Path(score), json_file, f"claims-{Path(claims).stem}.html"
            )
            return 0
        _tell(score_so_far(Path(score)), Path(score), json_file)
        return 0
    if export is not None and (peers is not None or json_file is not None):
        raise InputError("--export asks nobody and scores nothing", mend="leave --peers, --no-peers and --json away")
    folder = out or Path("denoc-proof")
    if resume is not None:
        folder = Path(resume)
        if out is not None and out != folder:
            raise InputError("--resume and --out name different folders", mend="give the one or the other")
        if not (folder / "plan.json").exists():
            raise InputError("holds no proof to go on with", source=folder, mend="give the folder of an earlier --out")
    elif folder.exists() and not nothing_in(folder):
        raise InputError("is not empty", source=folder, mend=f"give another --out, or go on with --resume {folder}")
    counts = QUICK if quick else FULL if cases is None else scaled(cases)
    if export is not None:
        _export(folder, Path(export), seed, counts, quick, workers, dask)
        return 0
    if dask is None:
        # Each process would compile its own kernels.
        from harness.denoc.compiling import ahead

        ahead.everything()
    with progress("prove") as step:
        try:
            proof = run(
                folder,
                seed=seed,
                counts=counts,
                short=quick,
                workers=workers,
                dask=dask,
                peers=peers,
                progress=lambda stage, done, of: step(done, of, stage),
            )
        except KeyboardInterrupt:
            raise Interrupted(f"stopped; `denoc prove --resume {folder}` goes on from here") from None
    _tell(proof, folder, json_file)
    return 0


def _export(
    folder: Path,
    to: Path,
    seed: int | None,
    counts: Mapping[str, int],
    short: bool,
    workers: int | None,
    dask: str | None,
) -> None:
    """Conceal, and write what others may see; says where the answers are."""
    from harness.errors import InputError
    from harness.proof.export import GUESSED, export, seed_of_export
    from harness.proof.run import conceal_all

    if to.exists() and (not to.is_dir() or any(to.iterdir())):
        raise InputError("is not empty", source=to, mend="give --export a new folder")
    if to.resolve() == folder.resolve() or folder.resolve() in to.resolve().parents:
        raise InputError("is where the answers are kept", source=to, mend="give --export a folder outside of --out")
    with progress("prove") as step:
        try:
            if seed is None and not (folder / "plan.json").exists():
                seed = seed_of_export()
            drawn_from, _ = conceal_all(
                folder, seed=seed, counts=counts, short=short, disguised=True, workers=workers, dask=dask,
                progress=lambda stage, done, of: step(done, of, stage),
            )  # fmt: skip
        except KeyboardInterrupt:
            raise Interrupted(f"stopped; `denoc prove --resume {folder} --export {to}` goes on from here") from None
    count = export(folder, to)
    screen = console(None)
    screen.print(f"wrote {count} cases without answers to {to}; keep {folder}, which has them", markup=False)
    if drawn_from < GUESSED:
        screen.print(
            f"seed {drawn_from} is short: who tries all of that size can draw these cases, and their answers, again; "
            "for entrants you do not know give no --seed",
            markup=False,
        )


def _tell(proof: Proof, folder: Path, json_file: str | None, page: str = "report.html") -> None:
    """Table on the terminal, page in the folder, document where it is asked for."""
    from harness.json_text import json_text
    from harness.report.proof import print_proof
    from harness.report.proof_page import proof_html

    document = proof.to_json()
    screen = console(json_file)
    print_proof(document, screen)
    screen.print(f"wrote {write_whole(folder / page, proof_html(document))}", markup=False)
    write_json(json_text(document), json_file)
