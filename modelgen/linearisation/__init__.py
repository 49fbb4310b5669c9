"""Equilibria near the start of a scene, and small motions about them.

Takes in a `Derivation` and a `Library`; gives out a `Linearised`: forces at rest, matrices M, C, K,
frequencies and modes. May import everything up to `runtime`.
"""
