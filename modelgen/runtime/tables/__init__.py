"""The tables of the core (modelgen.h) as ctypes structures, filled from the instance of a manifest."""
