"""The numbers that decide how sets of effects are searched, begun and weighed, by subject."""
