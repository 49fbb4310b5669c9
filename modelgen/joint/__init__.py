"""Joints: constraint equations of two frames, their coordinates, limits and springs.

Takes in the kinds of joint of a `Model`; gives out CasADi functions: rows with J and Gamma1, coordinates,
limits in the form of contacts, wrenches of springs. May import `geometry`, `dynamics`, `model` and what
lies before.
"""
