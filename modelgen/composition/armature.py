"""Armature of joints in the equations of a whole scene: with the rows J of all armature, scaled by the roots
of the inertias, M + J^T J takes the place of the mass matrix M of the bodies.

Its inverse follows from the block-diagonal M by Woodbury's formula (Golub and Van Loan, Matrix Computations,
section 2.1.4), and the forces of the armature on the bodies are -J^T (J a + gamma) at the accelerations a.
"""

from __future__ import annotations

from collections.abc import Sequence

import casadi as ca

from modelgen.composition.constraint_forces import regular
from modelgen.composition.constraint_rows import Row
from modelgen.composition.moving_bodies import MovingBody, mass_matrix, times_inverse_body_mass
from modelgen.composition.scene_symbols import Expression


def with_armature(
    rows: Sequence[Row], bodies: list[MovingBody], accelerations: Expression, *, curved: bool
) -> Expression:
    """Accelerations (n_u, k) that wrenches give the bodies, with the armature of the joints.

    Args:
        rows: of the armature.
        accelerations: (n_u, k) of the bodies without armature.
        curved: whether they are those of a motion, to which gamma of the rows belongs.
    """
    if not rows:
        return accelerations
    J = ca.vertcat(*(row.J for row in rows))
    response = times_inverse_body_mass(bodies, J.T)
    rates = ca.mtimes(J, accelerations)
    if curved:
        rates = rates + ca.vertcat(*(row.gamma for row in rows))
    forces = regular(ca.mtimes(J, response) + ca.DM.eye(len(rows)), rates, symmetric=True)
    return accelerations - ca.mtimes(response, forces)


def whole_mass(rows: Sequence[Row], bodies: list[MovingBody]) -> Expression:
    """M (n_u, n_u) of bodies and armature."""
    mass = mass_matrix(bodies)
    for row in rows:
        mass = mass + ca.mtimes(row.J.T, row.J)
    return mass
