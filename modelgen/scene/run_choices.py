"""The names between which a setting of a run chooses."""

ACCURACIES = ("coarse", "fast", "balanced", "tight")
METHODS = ("dop853", "rk4", "time-stepping")
SCHEMES = ("stewart-trinkle", "anitescu-potra", "moreau")
IMPACTS = ("simultaneous", "sequential")
SOLVERS = ("coulomb", "qp", "lcp", "mpcc", "polyhedral", "relaxation")
COMPILED_SOLVERS = ("coulomb", "relaxation")  # with friction, in the core
APPROXIMATE = ("polyhedral", "relaxation")  # laws in the place of Coulomb's
REALS = ("double", "float", "long double")
LEVELS = ("O1", "O2", "O3")
STEPPED = METHODS[1:]  # by fixed steps
FORMS = (
    *("auto", "explicit", "support", "implicit", "block", "mixed", "paper", "differentiated"),
    *("curve_implicit", "curve_block", "curve_paper", "curve_differentiated"),
    *("curves_block", "curves_paper", "curves_differentiated"),
    *("centre_surface", "centre_curve", "edge_edge"),
)
