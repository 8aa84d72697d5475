"""Closed loops: cut joints, whose constraint forces are eliminated from the recursions of the tree."""
