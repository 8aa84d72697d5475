"""Colours of the nominal, refitted and augmented model, the same in every picture."""

BEFORE, REFITTED, AFTER, PREDICTIVE = "#d55e00", "#e69f00", "#0a7bbd", "#009e73"
