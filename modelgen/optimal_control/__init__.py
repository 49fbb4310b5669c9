"""Optimal control of scenes with contacts: programs with complementarity constraints, solved by IPOPT.

In: a model, a horizon, and what is wanted of it. Out: states, forces and inputs at the ends of elements.
"""
