"""Trajectories, spectra, attribution, how motions part.

Pure functions: ``quantities`` (how far apart), ``odd_one_out`` (who stands alone), ``trajectories`` (first divergence, and
the horizon of chaotic motion), ``divergence_shape`` (in what way two motions part), ``attribution`` (which term is to blame).
"""
