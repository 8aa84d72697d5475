"""Identified models held against recordings: which predicts better where, what they agree on, what the recordings leave
open."""
