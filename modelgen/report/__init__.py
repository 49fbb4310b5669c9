"""Reports: checks, derivations, summaries, plots, pages, saved runs.

Takes in models, derivations and trajectories; gives out text, tables, pictures and files. Nothing here
computes motion. May import everything up to `linearisation`.
"""
