"""Residual checks, one file each: add a file that says ``CHECK = Check(…)`` and its name to the catalogue, and it is asked."""
