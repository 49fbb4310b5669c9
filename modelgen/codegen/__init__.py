"""Code generation: from a Derivation to C text, a compiled library and its manifest.

Takes in a `Derivation`; gives out a `Package` (C text and manifest), then a `Library` (compiled, loaded,
checked). The core is compiled once and kept in the user's cache; a scene compiles its kernels and a table
of functions. May import everything up to `verification`. Files are written by `build` and
`runtime_object` alone.
"""
