"""The built-in suite, one file a case, each citing its truth.

A case is a module ``harness/cases/<name>.py`` that states facts and is found by itself; it defines ``CASE`` (one
:class:`Case`) or ``CASES`` (a tuple of them, or a function without arguments that returns one)::

    from harness.cases.case import Case
    from harness.cases.checks import StateAgreement, TrajectoryAgreement, FrequencyTruth

    def system() -> System: ...          # a module-level function, so that a worker process finds it again

    CASE = Case(
        name="flexible_pendulum",        # unique; the key of the accepted figures in reference/
        title="The flexible pendulum of the paper, 1 mm steel strip",
        source="Euler-Bernoulli closed form …; Exudyn ANCF",   # where the truth comes from
        system=system,
        checks=(
            FrequencyTruth(values=(37.540, 103.08), allowed=1e-6, why="…", cites="closed form, …"),
            TrajectoryAgreement(…),
        ),
        group="flexible",                # rigid, chaos, scale, robots, flexible: the heading in the report
        engines=("denoc", "exudyn"),     # or None: every engine of the registry that does not refuse the system
        cost=12.0,                       # rough seconds, so that long ones start first
    )

A check is a small frozen dataclass with a ``quantity`` and a method ``run(bench: Bench) -> Iterable[Row | Series]``
(:mod:`harness.cases.case`); :class:`Row` is a line of the table, :class:`Series` is data for a plot of the report.
``Bench`` gives it the system, the engines' models, a random generator that depends on the case's name alone, and
``bench.row(…)``, which decides the verdict. Ready-made checks are in :mod:`harness.cases.checks`; what fits none of
them is ``Measured(quantity, function)``: a function of the bench in the case's own file that yields rows and series.
"""

from typing import TYPE_CHECKING, Any

from harness.cases.case import Bench, Case, Check, Row, Series

if TYPE_CHECKING:
    from harness.cases.results import Results
    from harness.cases.run import validate

__all__ = ["Bench", "Case", "Check", "Results", "Row", "Series", "validate"]


def __getattr__(name: str) -> Any:
    # The runner needs every engine's adapter; a case's file needs none of them.
    if name == "validate":
        from harness.cases.run import validate

        return validate
    if name == "Results":
        from harness.cases.results import Results

        return Results
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
