"""How kernels are compiled: numba led through them, kept on disk, made ahead of use."""
