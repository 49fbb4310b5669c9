"""The heaps of `tests.benchmarks.heaps` in MuJoCo: the cost of a contact, and how deep bodies penetrate.

Run with `python -m tests.benchmarks.heaps_mujoco` for 40 to 640 bodies, or with their numbers as arguments;
needs the extra `peers`. The bowl is a height field of squares of 15 mm, whose triangles are within 0.06 mm of
it. Contacts are without friction, as stiff as the step permits (`solref` of two steps).
"""

from __future__ import annotations

import sys
from time import process_time
from typing import Any

import numpy as np

from modelgen.benchmark.peers.mjcf import words
from tests.benchmarks.heaps import DRAG, SAMPLES, SPIN_DRAG, UNTIL, heap

STEPS = (2e-3, 2e-4)  # s
HALF, POINTS = 1.5, 201  # m, half side of the height field, and its points along a side
TITLES = (
    *("bodies", "step (s)", "contacts with force", "CPU s per simulated s"),
    *("ms per contact and simulated s", "penetration (m)", "v^2 at the end over the largest"),
)
MODEL = """
<mujoco>
  <option integrator="implicitfast" timestep="{dt}" gravity="0 0 -9.81"/>
  <size memory="1G"/>
  <default><geom condim="1" solref="{reference} 1" solimp="0.99 0.9999 1e-4"/></default>
  <asset><hfield name="bowl" nrow="{n}" ncol="{n}" size="{half} {half} {top} 1"/></asset>
  <worldbody><geom type="hfield" hfield="bowl"/>{bodies}</worldbody>
</mujoco>
"""
BODY = '<body pos="{p}" quat="{q}"><freejoint/><geom type="ellipsoid" size="{axes}" density="500"/></body>'


def model_of(bodies: int, dt: float) -> Any:
    """The MjModel of a heap."""
    import mujoco

    stones = [body for body in heap(bodies).bodies if body.motion == "dynamic"]
    text = "".join(
        BODY.format(
            p=words(stone.pose.position),
            q=words(stone.pose.quaternion),
            axes=words([value for _, value in stone.shapes[0].parameters]),
        )
        for stone in stones
    )
    model = mujoco.MjModel.from_xml_string(
        MODEL.format(dt=dt, reference=2 * dt, n=POINTS, half=HALF, top=HALF**2, bodies=text)
    )
    at = np.linspace(-HALF, HALF, POINTS)
    heights = (at[:, None] ** 2 + at**2) / 2
    model.hfield_data[:] = (heights / HALF**2).ravel()
    return model


def row(bodies: int, dt: float) -> str:
    import mujoco

    model = model_of(bodies, dt)
    data = mujoco.MjData(model)
    per_sample, spent = round(UNTIL / SAMPLES / dt), 0.0
    contacts, squares, deepest = [], [], 0.0
    for _ in range(SAMPLES):
        begun = process_time()
        for _ in range(per_sample):
            v = data.qvel.reshape(-1, 6)
            w = np.einsum("nij,nj->ni", data.xmat[1:].reshape(-1, 3, 3), v[:, 3:])
            data.xfrc_applied[1:, :3], data.xfrc_applied[1:, 3:] = -DRAG * v[:, :3], -SPIN_DRAG * w
            mujoco.mj_step(model, data)
        spent += process_time() - begun
        depth = -data.contact.dist
        contacts.append(int((data.efc_force[: data.nefc] > 0).sum()))
        squares.append(float((data.qvel.reshape(-1, 6)[:, :3] ** 2).sum()))
        deepest = max(deepest, float(depth.max(initial=0.0)))
    mean = float(np.mean(contacts))
    cells = (
        *(f"{bodies}", f"{dt:g}", f"{mean:.0f}", f"{spent / UNTIL:.2f}"),
        *(f"{1e3 * spent / UNTIL / mean:.1f}", f"{deepest:.1e}", f"{squares[-1] / max(squares):.1e}"),
    )
    return f"| {' | '.join(cells)} |"


def main() -> None:
    print(f"| {' | '.join(TITLES)} |\n{'|---' * len(TITLES)}|", flush=True)
    for bodies in [int(text) for text in sys.argv[1:]] or (40, 160, 640):
        for dt in STEPS:
            print(row(bodies, dt), flush=True)


if __name__ == "__main__":
    main()
