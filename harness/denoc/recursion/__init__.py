"""The recursive DeNOC dynamics of one mechanism, rigid and flexible, O(n)."""
