"""The equations of a whole scene, composed from the kernels of its kinds, as one CasADi function.

In: a Model, the functions of its kinds by name, and the mode of its contacts. Out: right-hand side, step,
and complementarity conditions. The core composes the same equations in C; nothing of this is compiled into a
library.
"""
