"""The catalogue: law, parameters with units and bounds, words, how each engine expresses it."""
