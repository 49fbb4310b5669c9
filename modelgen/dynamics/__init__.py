"""Rigid bodies and loads: Newton-Euler kernels, wrenches, and the composed right-hand side."""
