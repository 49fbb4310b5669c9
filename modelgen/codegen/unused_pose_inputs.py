"""Poses and twists, or parts of them, on which no output of a kernel depends."""

from __future__ import annotations

from collections.abc import Iterator

import casadi as ca
import numpy as np

PARTS = {12: ("position", "rotation", 3), 6: ("velocity", "spin", 3)}  # of a pose and a twist, by their size


def unused_pose_inputs(function: ca.Function) -> list[str]:
    """Names of poses and twists, or of parts of them ("rotation of pose_f"), that change no output.

    A frictionless sphere about its centre of mass, for one, is alike in all orientations: its kernel takes
    a whole pose and reads the position alone.
    """
    return list(_unused(function))


def _unused(function: ca.Function) -> Iterator[str]:
    arguments = function.sx_in()
    outputs = ca.veccat(*function.call(arguments))
    for name, argument in zip(function.name_in(), arguments, strict=True):
        if not name.startswith(("pose", "twist")) or argument.numel() not in PARTS:
            continue
        is_used = np.array(ca.which_depends(outputs, argument, 1, False), dtype=bool)
        first, second, end = PARTS[argument.numel()]
        if not is_used.any():
            yield name
        elif not is_used[:end].any():
            yield f"{first} of {name}"
        elif not is_used[end:].any():
            yield f"{second} of {name}"
