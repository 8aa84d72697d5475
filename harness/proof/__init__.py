"""Conceal effects in recordings made by other engines, score what diagnosis finds."""
