"""Native dynamics by the decoupled natural orthogonal complement."""
