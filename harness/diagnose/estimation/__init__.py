"""Fitting one hypothesis: likelihood, noise, nonlinear least squares, intervals."""
