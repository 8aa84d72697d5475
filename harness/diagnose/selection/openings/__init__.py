"""Openings of a search, a file each."""
