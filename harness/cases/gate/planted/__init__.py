"""The full self-test: faults planted over every path, each of which must close the gate and be called by its name."""
