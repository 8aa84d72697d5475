"""Scanned effects, one file each: add a file with the effect's name that says ``SCAN = Scan(…)``, and its name to the catalogue."""
