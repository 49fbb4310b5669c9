"""Composite shapes as features with adjacency, one family a file."""
