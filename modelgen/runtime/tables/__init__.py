"""The tables of the core (modelgen.h) as ctypes structures.

Takes in a manifest and an `Accuracy`; gives out mg_system and mg_settings with the arrays that they point to.
"""
