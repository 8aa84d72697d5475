"""Ways to rewrite a set of effects, one file each: add a file that says ``REWRITE = Rewrite(…)``, and its name to the catalogue."""
