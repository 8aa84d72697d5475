"""Motion in time of one mechanism: integrators, sensors on beams, small motion."""
