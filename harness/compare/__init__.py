"""Trajectories, spectra, attribution, error budget."""
