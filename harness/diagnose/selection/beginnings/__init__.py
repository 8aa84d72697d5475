"""Ways to begin a fit with one more effect, one file each: add a file that says ``BEGINNING = Beginning(…)``, and its name."""
