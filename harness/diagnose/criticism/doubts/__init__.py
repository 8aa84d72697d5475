"""Reasons to doubt members of a set, one file each: add a file that says ``REASON = Reason(…)``, and its name to the catalogue."""
