"""`--to urdf`: bodies, shapes and joints of a scene as URDF, which has no contacts, loads or velocities."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from math import atan2, hypot
from xml.etree import ElementTree

import numpy as np

from modelgen.benchmark.peers.scene_description import Setup, Solid, numbers
from modelgen.errors import ModelgenError
from modelgen.rotations import rotation_of
from modelgen.scene.pose_arithmetic import compose
from modelgen.scene.scene_types import Joint, Pose, Scene, Shape

SHAPES = ("sphere", "box", "cylinder")
JOINTS: Mapping[str, str] = {"revolute": "continuous", "prismatic": "prismatic", "weld": "fixed"}
REMEDY = "export --to c, fmu or mjcf"
WORLD = "world"
FLAT = 1e-12  # cosine of a pitch at which roll and yaw turn about one axis, so that all is yaw


def check_urdf(scene: Scene) -> None:
    """Raises ModelgenError that names what of a scene URDF has no like of."""
    refused = [*_unlike(scene)]
    if refused:
        raise ModelgenError(scene.source, "; ".join(refused), "URDF has no like of it", REMEDY)


def urdf_files(setup: Setup) -> dict[str, str]:
    """`NAME.urdf` of a scene that `check_urdf` lets pass."""
    scene = setup.scene
    root = ElementTree.Element("robot", name=scene.name)
    root.append(ElementTree.Comment(_left_out(scene)))
    ElementTree.SubElement(root, "link", name=WORLD)
    parents = {joint.between[1]: joint for joint in scene.joints}
    for solid, body in zip(setup.solids, scene.bodies, strict=True):
        joint = parents.get(body.name)
        root.append(_link(solid, _frame(joint)))
        root.append(_joint(joint, parents) if joint else _free(body.name, body.motion == "fixed", body.pose))
    ElementTree.indent(root)
    return {f"{scene.name}.urdf": ElementTree.tostring(root, encoding="unicode", xml_declaration=True) + "\n"}


def _unlike(scene: Scene) -> Iterator[str]:
    for body in scene.bodies:
        if body.motion == "driven":
            yield f"body {body.name!r} is driven along a path"
        for shape in body.shapes:
            if shape.cavity:
                yield f"shape {body.name}/{shape.name} is a cavity"
            elif shape.kind not in SHAPES:
                yield f"shape {body.name}/{shape.name} is a {shape.kind}"
    children = [joint.between[1] for joint in scene.joints]
    for joint in scene.joints:
        if joint.kind not in JOINTS:
            yield f"joint {joint.name!r} is {joint.kind}"
        if joint.motion is not None or joint.is_sprung:
            yield f"joint {joint.name!r} has a prescribed motion, a spring or a damper"
        if children.count(joint.between[1]) > 1 or _is_in_loop(joint, scene):
            yield f"joint {joint.name!r} closes a loop"


def _is_in_loop(joint: Joint, scene: Scene) -> bool:
    above = {each.between[1]: each.between[0] for each in scene.joints}
    body, seen = joint.between[0], {joint.between[1]}
    while body in above and body not in seen:
        seen.add(body)
        body = above[body]
    return body in seen


def _left_out(scene: Scene) -> str:
    return (
        f" {scene.name}, exported by modelgen. URDF has neither contacts with restitution and friction, nor"
        " loads, sensors, gravity and velocities; the frame of a link is that of its joint, and coordinates"
        f" are zero where the frames coincide. Gravity of the scene: {' '.join(map(str, scene.gravity))} "
    )


def _frame(joint: Joint | None) -> Pose:
    """The frame of a link in the axes of its body as written: that of its joint."""
    return joint.frames[1] if joint else Pose()


def _inverse(pose: Pose) -> Pose:
    w, x, y, z = pose.quaternion
    turned = rotation_of(pose.quaternion).T @ np.array(pose.position)
    return Pose((-float(turned[0]), -float(turned[1]), -float(turned[2])), (w, -x, -y, -z))


def _link(solid: Solid, frame: Pose) -> ElementTree.Element:
    link = ElementTree.Element("link", name=solid.name)
    inner = _inverse(frame)
    if not solid.fixed:
        inertial = ElementTree.SubElement(link, "inertial")
        x, y, z = (float(each) for each in solid.centre)
        inertial.append(_origin(compose(inner, Pose((x, y, z)))))
        ElementTree.SubElement(inertial, "mass", value=repr(solid.mass))
        pairs = {"ixx": (0, 0), "ixy": (0, 1), "ixz": (0, 2), "iyy": (1, 1), "iyz": (1, 2), "izz": (2, 2)}
        values = {name: repr(float(solid.inertia[at])) for name, at in pairs.items()}
        ElementTree.SubElement(inertial, "inertia", values)
    for shape in solid.shapes:
        for role in ("visual", "collision"):
            part = ElementTree.SubElement(link, role, name=f"{shape.name}")
            part.append(_origin(compose(inner, shape.pose)))
            geometry = ElementTree.SubElement(part, "geometry")
            ElementTree.SubElement(geometry, shape.kind, _sizes(shape))
    return link


def _sizes(shape: Shape) -> dict[str, str]:
    values = numbers(shape)
    if shape.kind == "box":
        return {"size": " ".join(repr(values[axis]) for axis in "xyz")}
    names = ("radius", "length") if shape.kind == "cylinder" else ("radius",)
    return {name: repr(values[name]) for name in names}


def _joint(joint: Joint, parents: Mapping[str, Joint]) -> ElementTree.Element:
    least, largest = joint.limits
    limited = joint.kind == "revolute" and least is not None and largest is not None
    element = ElementTree.Element(
        "joint", name=joint.name, type="revolute" if limited else JOINTS[joint.kind]
    )
    element.append(_origin(compose(_inverse(_frame(parents.get(joint.between[0]))), joint.frames[0])))
    ElementTree.SubElement(element, "parent", link=joint.between[0])
    ElementTree.SubElement(element, "child", link=joint.between[1])
    if joint.kind != "weld":
        ElementTree.SubElement(element, "axis", xyz="0 0 1")
    if limited or joint.kind == "prismatic":
        bounds = {"lower": least, "upper": largest}
        told = {key: repr(float(value)) for key, value in bounds.items() if value is not None}
        ElementTree.SubElement(element, "limit", {"effort": "1e9", "velocity": "1e9", **told})
    return element


def _free(name: str, fixed: bool, pose: Pose) -> ElementTree.Element:
    """A body that no joint holds, in the world."""
    kind = "fixed" if fixed else "floating"
    element = ElementTree.Element("joint", name=f"{WORLD}_{name}", type=kind)
    element.append(_origin(pose))
    ElementTree.SubElement(element, "parent", link=WORLD)
    ElementTree.SubElement(element, "child", link=name)
    return element


def _origin(pose: Pose) -> ElementTree.Element:
    xyz = " ".join(repr(float(each)) for each in pose.position)
    return ElementTree.Element("origin", xyz=xyz, rpy=" ".join(repr(each) for each in rpy_of(pose)))


def rpy_of(pose: Pose) -> tuple[float, float, float]:
    """Roll, pitch and yaw, rad, with R = Rz(yaw) Ry(pitch) Rx(roll)."""
    R = rotation_of(pose.quaternion)
    level = hypot(R[0, 0], R[1, 0])
    pitch = atan2(-R[2, 0], level)
    if level > FLAT:
        return atan2(R[2, 1], R[2, 2]), pitch, atan2(R[1, 0], R[0, 0])
    return 0.0, pitch, atan2(-R[0, 1], R[1, 1])
