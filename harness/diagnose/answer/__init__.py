"""The answer: findings with intervals, words, curves, the augmented model."""
