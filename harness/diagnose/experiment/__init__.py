"""Design of the next experiment: what would part the hypotheses that are left."""
