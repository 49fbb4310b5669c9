"""Rigid bodies and loads.

Takes in the kinds of a `Model`; gives out CasADi functions: pose, Newton-Euler equations and energy of a
body, wrenches of loads, and the right-hand side of small scenes in one function. May import `geometry`,
`model` and what lies before them.
"""
