"""The rate of the normal of each contact, at the samples of a run."""

from __future__ import annotations

from typing import Any

import numpy as np

from modelgen.assembly.shared_pair_content import eta_size
from modelgen.contact.form_table import contact_kernels
from modelgen.derivation import Derivation
from modelgen.errors import ModelgenError, expect
from modelgen.rotations import rotation_of
from modelgen.runtime.trajectory import Trajectory

Array = np.ndarray[Any, Any]


def normal_rates(derivation: Derivation, path: Trajectory) -> Array:
    """N-dot (n, nc, 3) 1/s, world axes: the rate of `path.normals` while the contact stays on its features.

    It is that of the form of the contact's equations, as Gamma2 contains it, evaluated at the poses, twists
    and eta of the samples. NaN where the contact is on no feature pair, and for limits of joints.

    Args:
        derivation: what `derive` returned for the scene of the run.
        path: a run of it.

    Raises ModelgenError if it is given something else, or a derivation of another scene.
    """
    expect("normal_rates", derivation, Derivation)
    expect("normal_rates", path, Trajectory)
    model = derivation.model
    names = tuple(body.name for body in model.bodies), tuple(contact.name for contact in model.contacts)
    if (path.body_names, path.contact_names[: len(model.contacts)]) != names:
        found = f"a run of {path.scene!r}, which has other bodies or contacts than {model.scene.name!r}"
        raise ModelgenError("normal_rates", found, "both of one scene", "derive the scene of the run")
    if dict(path.parameters) != {each.name: each.value for each in model.whole.parameters}:
        found = "a run with other values of the scene's parameters than the derivation"
        remedy = "write the values of the run into the scene, and derive that"
        raise ModelgenError("normal_rates", found, "both of the same values", remedy)
    rates = np.full(path.normals.shape, np.nan)
    poses, twists = _poses_and_twists(path)
    for k, contact in enumerate(model.contacts):
        for index in np.unique(path.feature_pair[:, k]).tolist():
            if not 0 <= index < len(model.feature_pairs):
                continue
            at = np.flatnonzero(path.feature_pair[:, k] == index)
            pair = model.feature_pairs[index]
            kind = model.contact_kinds[pair.kind]
            eta = path.eta[at, contact.eta : contact.eta + eta_size(kind)].astype(float)
            moving = [column[at, body].T for body in (pair.o, pair.f) for column in (poses, twists)]
            parameters = np.tile(np.array(pair.parameters).reshape(-1, 1), len(at))
            function = contact_kernels(kind).normal_rate
            arguments = [
                value[: function.size1_in(i)] for i, value in enumerate((*moving, eta.T, parameters))
            ]
            rates[at, k] = np.asarray(function(*arguments)).T
    return rates


def _poses_and_twists(path: Trajectory) -> tuple[Array, Array]:
    """(n, nb, 12) p and R column by column; (n, nb, 6) v in world axes, angular velocity in body axes."""
    quaternion = np.where(np.isnan(path.quaternion), (1.0, 0.0, 0.0, 0.0), path.quaternion).astype(float)
    w, x, y, z = np.moveaxis(quaternion, -1, 0)
    R = np.moveaxis(rotation_of((w, x, y, z)), (0, 1), (-2, -1))
    columns = np.swapaxes(R, -1, -2).reshape(*R.shape[:2], 9)
    spin = np.einsum("nbij,nbi->nbj", R, np.nan_to_num(path.w.astype(float)))
    return np.concatenate([path.p, columns], axis=-1), np.concatenate([path.v, spin], axis=-1)
