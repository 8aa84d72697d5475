"""Plots of a page: drawn once for paper, and again by a script inlined in the page, for zoom and hover."""

from harness.report.plots.plot import Line, Plot
from harness.report.plots.thin import thinned

__all__ = ["Line", "Plot", "thinned"]
