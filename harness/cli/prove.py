"""``denoc prove``: the blind proof."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import click

from harness.cli.interrupt import Interrupted
from harness.cli.options import console, output_options, progress, wide_options, write_json

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
    "--peers/--no-peers",
    default=None,
    help="Ask other methods about the same cases; default: in the full proof, where the extra [peers] is installed.",
)
@output_options("Folder of the proof: cases, sealed answers, digests, answers found, proof.json; default: denoc-proof.")
@wide_options
def prove(
    quick: bool,
    cases: int | None,
    seed: int | None,
    resume: str | None,
    score: str | None,
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
    """
    from harness.errors import InputError
    from harness.proof.run import FULL, QUICK, scaled, score_so_far
    from harness.proof.run import prove as run

    if quick and cases is not None:
        raise InputError("--quick and --cases do not go together", mend="give the one or the other")
    if score is not None:
        if quick or any(option is not None for option in (cases, seed, peers, resume, out)):
            raise InputError(
                "--score goes with none of the options that say what to prove", mend="give --score DIR alone"
            )
        _tell(score_so_far(Path(score)), Path(score), json_file)
        return 0
    folder = out or Path("denoc-proof")
    if resume is not None:
        folder = Path(resume)
        if out is not None and out != folder:
            raise InputError("--resume and --out name different folders", mend="give the one or the other")
        if not (folder / "plan.json").exists():
            raise InputError("holds no proof to go on with", source=folder, mend="give the folder of an earlier --out")
    elif folder.exists() and any(folder.iterdir()):
        raise InputError("is not empty", source=folder, mend=f"give another --out, or go on with --resume {folder}")
    counts = QUICK if quick else FULL if cases is None else scaled(cases)
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


def _tell(proof: Proof, folder: Path, json_file: str | None) -> None:
    """Table on the terminal, page in the folder, document where it is asked for."""
    from harness.report.files import write_whole
    from harness.report.json_text import json_text
    from harness.report.proof import print_proof
    from harness.report.proof_page import proof_html

    document = proof.to_json()
    screen = console(json_file)
    print_proof(document, screen)
    screen.print(f"wrote {write_whole(folder / 'report.html', proof_html(document))}", markup=False)
    write_json(json_text(document), json_file)
