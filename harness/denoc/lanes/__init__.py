"""Many copies of a mechanism at once, each with parameters of its own, and their motion in time."""
