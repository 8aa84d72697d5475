"""The pictures that tell the suite's story, in the order in which they are told."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

from harness.cases.case import Series
from harness.report.figures.lines import lines
from harness.report.figures.overlay import overlay
from harness.report.figures.spectra import spectra


@dataclass(frozen=True)
class Kind:
    """One kind of picture: its key in ``Series.figure``, heading, what to look for, and who draws it."""

    figure: str
    title: str
    words: str
    draw: Callable[[Sequence[Series], str], str]


KINDS = (
    Kind(
        "frequency_amplitude",
        "A swing's frequency depends on its amplitude",
        "The line is the elliptic integral, the marks are simulated. A decaying swing therefore has no single frequency: "
        "what is read from a recording depends on the window.",
        lines,
    ),
    Kind(
        "divergence",
        "Chaos, and how far it can be predicted",
        "Two native runs that start a billionth of a radian apart (dashed) show how fast anything small grows. "
        "Engines are compared up to the horizon measured from that; beyond it a difference says nothing.",
        lines,
    ),
    Kind(
        "trajectory",
        "The same motion in every engine",
        "Above, the motion; below, how far each engine is from the native one.",
        overlay,
    ),
    Kind(
        "tip_deflection",
        "Deflection of the tip, native against finite elements",
        "Like is compared with like: the geometrically exact beam has the stiffening of foreshortening, the floating "
        "frame has not.",
        overlay,
    ),
    Kind(
        "spectrum", "Swing and vibration parted", "Amplitude over frequency, of the same run in each engine.", spectra
    ),
    Kind(
        "convergence",
        "Convergence with modes and elements",
        "Error over the number of modes (native) or elements (finite elements).",
        lines,
    ),
    Kind(
        "frequency_spin",
        "Spinning stiffens",
        "Natural frequencies of a rotating beam over its spin rate, against published values.",
        lines,
    ),
    Kind("amplitude_decay", "Decay of the amplitude", "Amplitude of each half-swing over time.", lines),
    Kind(
        "misprints",
        "What each misprint does",
        "The paper's equations as printed, and as their misprints are mended one after the other, beside engines that never "
        "had them. A line ends where its equation has no solution, or has left the picture.",
        lines,
    ),
    Kind("cost", "Cost", "Time for one evaluation over the number of joints.", lines),
)


def kind_of(figure: str) -> Kind:
    """The kind of that key; an unknown one is drawn as plain lines under its own name."""
    return next((kind for kind in KINDS if kind.figure == figure), Kind(figure, figure.replace("_", " "), "", lines))
