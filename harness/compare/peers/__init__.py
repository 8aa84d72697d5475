"""Other tools for the same question, each run as those who know it run it: one way for proofs, benchmarks and real rigs
alike."""
