"""Recordings that differ: a level of dry friction for each."""
