"""Runs: numbers only, no symbols.

Takes in a `Library` and an `Accuracy`; gives out a `Trajectory`, closest points, answers of contact
problems. The C core does the work; this package fills its tables, calls it, and explains what it answers.
May import `codegen.manifest`, `codegen.library` and `codegen.amalgamation` and nothing symbolic.
"""
