"""Independent evidence for every formula: implicit differentiation, higher precision, closed forms, errata.

Takes in a `Derivation`; gives out the status of each formula with the error that was found. May import
everything up to `derivation`.
"""
