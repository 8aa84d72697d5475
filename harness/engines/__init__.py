"""One protocol, one file an engine."""
