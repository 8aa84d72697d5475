"""Flexible links: mode shapes, the integrals of a beam, what its modes leave out."""
