"""The version of this package, for who must not lean on all of it."""

__version__ = "0.1.0"
