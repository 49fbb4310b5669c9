"""CasADi functions of scenes for users: right-hand side, step, complementarity problem.

In: a model, derivation or library, and a run whose mode they take. Out: CasADi functions with exact
derivatives, and their compiled form.
"""
