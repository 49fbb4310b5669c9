"""The contact equations of the paper, one statement a file, and the table of forms (`kinds`).

Takes in the two partners of a contact kind as symbols; gives out kernels: gap, rows J and Gamma2,
derivatives of the contact parameters eta, a Newton step, margins. May import `geometry`, `model` and what
lies before them. Source: Anitescu, Cremer, Potra, Formulating 3D Contact Dynamics Problems (1995); each
docstring names its theorem.
"""
