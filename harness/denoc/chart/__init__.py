"""Positions on their manifold, and velocities, over the recursions for joints of one degree of freedom."""
