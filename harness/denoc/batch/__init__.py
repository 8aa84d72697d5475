"""Dynamics of one mechanism in many states, eight at a time."""
