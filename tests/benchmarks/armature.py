"""Joints with armature beside MuJoCo's Runge-Kutta method at 1e-4 s.

    python -m tests.benchmarks.armature [MEMBERS] [FILE.xml ...]

Random chains and trees of hinges, slides and balls with armature of 1e-3 to 10 times the inertia of their
links, springs, dampers and gravity, imported from MJCF; and models in files, without their contacts and
limits, from a random state. A row each: the largest difference of the centres of mass over the motion, m.
"""

from __future__ import annotations

import sys
import tempfile
from pathlib import Path
from xml.etree import ElementTree

import mujoco
import numpy as np

from modelgen import import_scene, simulate
from tests.running import library_of

UNTIL, SAMPLES, STEP, SPEED = 0.3, 6, 1e-4, 2.0  # s, 1, s, rad/s
KINDS = ("hinge", "hinge", "slide", "ball")


def numbers(values: np.ndarray) -> str:
    return " ".join(f"{value:.17g}" for value in values)


def random_model(seed: int) -> str:
    """A chain (even seeds) or a tree of three to six links, on the world or with a floating root."""
    random = np.random.default_rng(seed)
    root = ElementTree.Element("mujoco")
    ElementTree.SubElement(root, "option", timestep=str(STEP), integrator="RK4")
    bodies = [ElementTree.SubElement(root, "worldbody")]
    q: list[float] = []
    u: list[float] = []
    for k in range(int(random.integers(3, 7))):
        above = bodies[-1] if seed % 2 == 0 or k == 0 else bodies[int(random.integers(1, len(bodies)))]
        body = ElementTree.SubElement(above, "body", pos=numbers(random.uniform(-0.3, 0.3, 3)))
        body.set("name", f"link{k}")
        mass, size = random.uniform(0.5, 2.0), random.uniform(0.05, 0.2)
        inertia = mass * size**2 * random.uniform(0.6, 1.0, 3)
        given = {"mass": f"{mass:.17g}", "diaginertia": numbers(inertia)}
        ElementTree.SubElement(body, "inertial", given | {"pos": numbers(random.uniform(-0.2, 0.2, 3))})
        if k == 0 and seed % 3 == 0:
            ElementTree.SubElement(body, "freejoint")
            turn = random.normal(size=4)
            q += [0.0, 0.0, 1.0, *(turn / np.linalg.norm(turn))]
            u += list(SPEED * random.normal(size=6))
            bodies.append(body)
            continue
        kind = str(random.choice(KINDS))
        share = 10 ** random.uniform(-3, 1)
        keys = {"type": kind, "name": f"joint{k}", "pos": numbers(random.uniform(-0.1, 0.1, 3))}
        keys["armature"] = f"{share * (mass if kind == 'slide' else inertia.mean()):.17g}"
        keys["damping"] = f"{random.uniform(0.0, 0.05):.17g}" if kind != "ball" else "0"
        if kind != "ball":
            axis = random.normal(size=3)
            keys |= {
                "axis": numbers(axis / np.linalg.norm(axis)),
                "stiffness": f"{random.uniform(0.0, 5.0):.17g}",
            }
        ElementTree.SubElement(body, "joint", keys)
        if kind == "ball":
            turn = random.normal(size=4)
            q += list(turn / np.linalg.norm(turn))
        else:
            q.append(random.uniform(-1.0, 1.0) * (0.1 if kind == "slide" else 1.0))
        u += list(random.normal(size=3 if kind == "ball" else 1) * (0.3 if kind == "slide" else SPEED))
        bodies.append(body)
    frame = ElementTree.SubElement(root, "keyframe")
    ElementTree.SubElement(frame, "key", name="start", qpos=numbers(np.array(q)), qvel=numbers(np.array(u)))
    return ElementTree.tostring(root, encoding="unicode")


def difference(path: Path) -> float:
    """Largest difference of the centres of mass over the motion, m."""
    imported = import_scene(path)
    run = simulate(library_of(imported.scene), until=UNTIL, samples=SAMPLES, accuracy="tight", estimate=False)
    model = mujoco.MjModel.from_xml_path(str(path))
    data = mujoco.MjData(model)
    mujoco.mj_resetDataKeyframe(model, data, 0)
    worst = 0.0
    for sample in range(1, SAMPLES + 1):
        mujoco.mj_step(model, data, nstep=round(UNTIL / SAMPLES / STEP))
        mujoco.mj_kinematics(model, data)
        for name, place in zip(run.body_names, run.p[sample], strict=True):
            body = mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_BODY, name)
            if body > 0:
                worst = max(worst, float(np.abs(place - data.xipos[body]).max()))
    return worst


def free_of_contact(path: Path, seed: int) -> str:
    """A model as text, with RK4, without contacts and limits, from a random state near the one drawn."""
    spec = mujoco.MjSpec.from_file(str(path))
    spec.option.integrator = mujoco.mjtIntegrator.mjINT_RK4
    spec.option.timestep = STEP
    for flag in (mujoco.mjtDisableBit.mjDSBL_CONTACT, mujoco.mjtDisableBit.mjDSBL_LIMIT):
        spec.option.disableflags |= int(flag)
    for key in list(spec.keys):
        spec.delete(key)
    model = spec.compile()
    random = np.random.default_rng(seed)
    q, u = model.qpos0.copy(), SPEED * random.normal(size=model.nv)
    mujoco.mj_integratePos(model, q, random.uniform(-0.3, 0.3, model.nv), 1.0)
    spec.add_key(name="start", qpos=q, qvel=u)
    spec.compile()
    return str(spec.to_xml())


def main(members: int, files: list[Path]) -> None:
    worst = 0.0
    with tempfile.TemporaryDirectory() as folder:
        for seed in range(members):
            path = Path(folder) / f"random{seed}.xml"
            path.write_text(random_model(seed), encoding="utf-8")
            found = difference(path)
            worst = max(worst, found)
            print(f"{path.stem:24} {found:.1e} m", flush=True)
        for file in files:
            path = Path(folder) / file.name
            path.write_text(free_of_contact(file, 1), encoding="utf-8")
            print(f"{file.stem:24} {difference(path):.1e} m", flush=True)
    print(f"largest of the random ones: {worst:.1e} m")


if __name__ == "__main__":
    main(int(sys.argv[1]) if len(sys.argv) > 1 else 30, [Path(name) for name in sys.argv[2:]])
