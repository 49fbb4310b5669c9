"""A file of MJCF or URDF as MuJoCo compiles it, at the state where a run begins (extra `import`)."""

from __future__ import annotations

import os
import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import numpy as np

from modelgen.errors import ModelgenError, install
from modelgen.importing.import_losses import Notes
from modelgen.importing.xml_file import xml_root
from modelgen.name_suggestions import nearest

Array = np.ndarray[Any, np.dtype[np.float64]]
START_KEYS = ("start", "home")  # keyframes that a run begins with, unless one is named
UNREAD = {"mimic", "transmission", "gazebo", "safety_controller"}  # of URDF, which MuJoCo does not read
WORLD = "world"
LARGEST = 1e30  # of the numbers of a file, in SI units, as of a scene
UNIT = ("body_quat", "body_iquat", "geom_quat", "site_quat", "jnt_axis")  # unit vectors of a model
CLOSE = 1e-6  # of the length of a unit vector to 1
MESH_ENDS = (".stl", ".obj", ".msh")


@dataclass(frozen=True)
class Compiled:
    """A model and its state at the start, with positions and velocities of all bodies.

    Attributes:
        mj: the module `mujoco`.
        model: an MjModel.
        data: an MjData at the start.
        key: name of the keyframe that it begins with, or empty.
    """

    mj: Any
    model: Any
    data: Any
    key: str
    control: Array

    def name(self, kind: str, number: int) -> str:
        """The name of an element, such as ("geom", 3), as the file has it; empty where it has none."""
        found = self.mj.mj_id2name(self.model, getattr(self.mj.mjtObj, f"mjOBJ_{kind.upper()}"), number)
        return found or ""

    def told(self, kind: str, number: int) -> str:
        """The element in words: `geom 'foot'` or `geom 3`."""
        name = self.name(kind, number)
        return f"{kind} {name!r}" if name else f"{kind} {number}"

    def is_disabled(self, part: str) -> bool:
        return bool(self.model.opt.disableflags & getattr(self.mj.mjtDisableBit, f"mjDSBL_{part}"))


def compiled(path: Path, urdf: bool, key: str | None, floating: bool, notes: Notes) -> Compiled:
    """The model of a file.

    Args:
        urdf: whether it is URDF.
        floating: of URDF, whether the first link is free to move.
        key: name or number of the keyframe to begin with; "start" or "home" where there is one, if None.

    Raises:
        ModelgenError: MuJoCo is missing, does not read the file, or has no such keyframe.
    """
    mj = mujoco()
    with _quiet(mj):
        try:
            spec = (
                mj.MjSpec.from_string(_urdf_text(path, floating, notes))
                if urdf
                else mj.MjSpec.from_file(str(path))
            )
            _strip(spec, mj)
            _check_meshes(spec, mj, path, notes)
            model = spec.compile()
        except ValueError as refused:
            found = f"MuJoCo refuses it: {_line(refused)}"
            raise ModelgenError(str(path), found, "", "mend the file") from None
        _check_numbers(model, path)
        data = mj.MjData(model)
        name = _begin(mj, model, data, key, path)
    control = np.array(data.ctrl)
    return Compiled(mj, model, data, name, control)


@contextmanager
def _quiet(mj: Any) -> Iterator[None]:
    """Keep what MuJoCo and its library for hulls print of a file: an error says what matters."""
    before, kept = mj.get_mju_user_warning(), os.dup(2)
    nowhere = os.open(os.devnull, os.O_WRONLY)
    try:
        mj.set_mju_user_warning(lambda text: None)
        os.dup2(nowhere, 2)
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            yield
    finally:
        os.dup2(kept, 2)
        mj.set_mju_user_warning(before)
        os.close(kept)
        os.close(nowhere)


def _check_numbers(model: Any, path: Path) -> None:
    """Raise ModelgenError for a number of the model that is not finite or too large to compute with, and for
    a direction that is none, as of an axis whose length is beyond the reals."""
    arrays = {name: getattr(model, name) for name in dir(model) if not name.endswith("_aabb")}
    arrays |= {name: getattr(model.opt, name) for name in ("gravity", "wind", "density", "viscosity")}
    for name, values in arrays.items():
        if not isinstance(values, float | np.ndarray) or np.asarray(values).dtype.kind != "f":
            continue
        numbers = np.asarray(values)
        wrong = numbers[~(np.abs(numbers) <= LARGEST)]
        if wrong.size:
            found, allowed = f"{wrong[0]:g} in {name}", f"numbers up to {LARGEST:g}"
            raise ModelgenError(str(path), found, allowed, "mend the file, or what it names")
    for name in UNIT:
        if (np.abs(np.linalg.norm(arrays[name], axis=-1) - 1) > CLOSE).any():
            raise ModelgenError(str(path), f"no direction in {name}", "a vector of some length", "mend it")


def mujoco() -> Any:
    """The module; raises ModelgenError where it is missing, or too old to edit what it reads."""
    try:
        import mujoco
    except ImportError:
        raise ModelgenError("modelgen import", "no package 'mujoco'", "", install("import")) from None
    if not hasattr(mujoco.MjSpec, "delete"):
        raise ModelgenError(
            "modelgen import", f"mujoco {mujoco.__version__}", "3.3.6 or newer is needed",
            "run: pip install -U mujoco",
        )  # fmt: skip
    return mujoco


def _line(error: Exception) -> str:
    return " ".join(str(error).split()).removeprefix("Error: ")


def _urdf_text(path: Path, floating: bool, notes: Notes) -> str:
    """The text of a URDF with the places of its meshes, and notes on what MuJoCo does not read."""
    try:
        root = xml_root(path)
    except ValueError as error:
        raise ModelgenError(str(path), f"no XML: {error}", "", "mend the file") from None
    for element in root.iter():
        if element.tag in UNREAD:
            notes.omit(f"<{element.tag}> of URDF")
    for each in root.iter("joint"):
        for mimic in each.iter("mimic"):
            notes.refuse("constraints", f"joint {each.get('name')!r} follows joint {mimic.get('joint')!r}")
    for link in root.iter("link"):
        for visual in link.findall("visual"):
            link.remove(visual)
    for mesh in root.iter("mesh"):
        mesh.set("filename", str(_found(mesh.get("filename", ""), path)))
    for each in root.findall("mujoco"):
        root.remove(each)
    _place_first_link(root, floating, notes)
    own = ElementTree.SubElement(root, "mujoco")
    ElementTree.SubElement(own, "compiler", strippath="false", fusestatic="false", discardvisual="true")
    return ElementTree.tostring(root, encoding="unicode")


def _place_first_link(root: ElementTree.Element, floating: bool, notes: Notes) -> None:
    """Let the first link float, or note that it rests."""
    children = {child.get("link") for joint in root.findall("joint") for child in joint.findall("child")}
    first = [link.get("name", "") for link in root.findall("link") if link.get("name") not in children]
    if first == [WORLD] or len(first) != 1:
        return
    if not floating:
        notes.approximate(
            f"link {first[0]!r}, to which the others are joined, rests (--floating lets it move)"
        )
        return
    ElementTree.SubElement(root, "link", name=WORLD)
    joint = ElementTree.SubElement(root, "joint", name=f"{WORLD}_{first[0]}", type="floating")
    ElementTree.SubElement(joint, "parent", link=WORLD)
    ElementTree.SubElement(joint, "child", link=first[0])


def _found(name: str, path: Path) -> Path:
    """The file of a mesh: `package://NAME/...` is looked for in the folders above."""
    local = name.removeprefix("file://")
    if not name.startswith("package://"):
        return (path.parent / local).resolve()
    package, _, rest = name.removeprefix("package://").partition("/")
    for folder in path.resolve().parents:
        for place in (folder / package / rest, folder / rest):
            if place.exists():
                return place
    return (path.parent / rest).resolve()


def _strip(spec: Any, mj: Any) -> None:
    """Take away what is only seen: its files need not be there."""
    for geom in list(spec.geoms):
        geom.material = ""
        if _is_seen_only(geom, spec, mj):
            spec.delete(geom)
    for each in (*spec.sites, *spec.tendons):
        each.material = ""
    used = {geom.meshname for geom in spec.geoms}
    for group in (spec.skins, spec.materials, spec.textures):
        for each in list(group):
            spec.delete(each)
    for mesh in list(spec.meshes):
        if mesh.name not in used and not spec.skins and not spec.flexes:
            spec.delete(mesh)


def _is_seen_only(geom: Any, spec: Any, mj: Any) -> bool:
    """Whether a geom of a mesh touches nothing and has no part in the mass of its body."""
    weighs = spec.compiler.inertiafromgeom == mj.mjtInertiaFromGeom.mjINERTIAFROMGEOM_TRUE
    massless = geom.mass == 0 or (geom.parent.explicitinertial and not weighs)
    paired = any(geom.name and geom.name in (pair.geomname1, pair.geomname2) for pair in spec.pairs)
    silent = geom.contype == 0 and geom.conaffinity == 0
    return bool(geom.meshname and silent and massless and not paired)


def _check_meshes(spec: Any, mj: Any, path: Path, notes: Notes) -> None:
    """Note meshes that cannot be read, and take their geoms away."""
    for mesh in list(spec.meshes):
        if not mesh.file:
            continue
        place = _mesh_place(mesh, spec, path)
        if place.suffix.lower() not in MESH_ENDS:
            told = f"mesh {place.name!r} is none of {', '.join(MESH_ENDS)}"
        elif not place.exists():
            told = f"mesh {place.name!r} is not there"
        else:
            continue
        notes.refuse("meshes", told)
        for geom in list(spec.geoms):
            if geom.meshname == mesh.name:
                spec.delete(geom)
        spec.delete(mesh)
    notes.check()


def _mesh_place(mesh: Any, spec: Any, path: Path) -> Path:
    name = Path(mesh.file).name if spec.strippath else mesh.file
    return path.parent / (spec.meshdir or "") / name


def _begin(mj: Any, model: Any, data: Any, key: str | None, path: Path) -> str:
    """Put the state at its keyframe; its name."""
    names = [model.key(k).name for k in range(model.nkey)]
    number = _key_number(names, key, path)
    if number is None:
        mj.mj_resetData(model, data)
    else:
        mj.mj_resetDataKeyframe(model, data, number)
    mj.mj_forward(model, data)
    return "" if number is None else names[number] or str(number)


def _key_number(names: list[str], key: str | None, path: Path) -> int | None:
    if key is None:
        return next((names.index(name) for name in START_KEYS if name in names), None)
    if key in names:
        return names.index(key)
    if key.isdigit() and int(key) < len(names):
        return int(key)
    allowed = "keyframes: " + ", ".join(name or str(k) for k, name in enumerate(names))
    raise ModelgenError(f"--key {key}", f"{path.name} has no such keyframe", allowed, nearest(key, names))


def geoms_of(model: Any, body: int) -> Iterator[int]:
    first = int(model.body_geomadr[body])
    yield from range(first, first + int(model.body_geomnum[body]))
