"""Sections of the HTML report: a small class and a template each."""
