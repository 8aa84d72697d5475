"""The question: system, recordings, windows, candidate effects, hypotheses."""
