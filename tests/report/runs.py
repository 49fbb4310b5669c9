"""A run made by hand: a ball that rolls around a ring on a table, and rests there for its second half."""

from __future__ import annotations

import numpy as np

from modelgen.report.run_record import Record


def ball_on_table(n: int = 41) -> Record:
    """One contact; the table is body o at the origin, the ball f (radius 0.1 m) a quarter turn about x."""
    t = np.linspace(0.0, 2.0, n)
    p = np.zeros((n, 2, 3))
    p[:, 1] = np.stack((np.cos(t), np.sin(t), np.full(n, 0.1)), axis=1)
    quaternion = np.tile([[1.0, 0.0, 0.0, 0.0], [np.sqrt(0.5), np.sqrt(0.5), 0.0, 0.0]], (n, 1, 1))
    touching = p[:, 1:] - np.array([0.0, 0.0, 0.1])
    columns = {
        **{"t": t, "p": p, "quaternion": quaternion, "eta": np.zeros((n, 0))},
        **{"v": np.gradient(p, t, axis=0), "w": np.zeros((n, 2, 3))},
        **{"force": np.where(t < 1.0, 9.81, 0.0)[:, None], "gap": np.zeros((n, 1))},
        **{name: np.zeros((n, 1, 3)) for name in ("friction", "contact_torque", "slip")},
        **{"points_o": touching, "points_f": touching, "normals": np.tile([[[0.0, 0.0, 1.0]]], (n, 1, 1))},
        **{
            "energy": np.full(n, 0.5),
            "work": np.zeros(n),
            "coordinates": np.zeros((n, 0)),
            "sensors": np.zeros((n, 0)),
        },
        **{"joint_force": np.zeros((n, 0, 3)), "joint_torque": np.zeros((n, 0, 3))},
        **{f"{kind}_error": np.full(n, 1e-9) for kind in ("position", "rotation", "velocity", "spin")},
        **{"patch": np.zeros((n, 0)), "patch_force": np.zeros((n, 0)), "patch_spin": np.zeros((n, 0))},
        **{name: np.zeros((n, 0, 3)) for name in ("patch_point", "patch_friction", "patch_slip")},
        **{"patch_torque": np.zeros((n, 0)), "patch_share": np.zeros((n, 0))},
    }
    meshes = {"0_o": np.zeros((3, 4, 3)) + np.linspace(0, 1, 4)[None, :, None]}
    summary = {"scene": "ring", "outcome": "done", "t_end": 2.0, "events": [], "doubts": [], "estimate": None}
    return Record(columns, ("table", "ball"), ("ball-table",), np.array([[0, 1]]), meshes, summary)
