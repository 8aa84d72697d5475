"""Trajectories, spectra, attribution, error budget.

Pure functions: ``quantities`` (how far apart), ``odd_one_out`` (who stands alone), ``trajectories`` (first divergence, and
the horizon of chaotic motion), ``error_budget`` (what a difference is made of), ``attribution`` (which term is to blame).
"""
