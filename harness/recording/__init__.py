"""Recordings: read, map, check; sensors as measurement models."""
