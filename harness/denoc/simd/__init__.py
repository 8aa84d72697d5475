"""Eight numbers as one: vectors of lanes, and moving lanes within them."""
