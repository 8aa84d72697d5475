"""Efforts as the measurement: inverse dynamics along the recorded motion."""
