"""Locate, hypothesise, fit, select, explain, propose the next experiment."""
