"""Runs to files and back: npz keeps everything, CSV the columns that a spreadsheet can use."""

from __future__ import annotations

import csv
import hashlib
import io
import json
from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np

from modelgen.errors import ModelgenError, expect, path_of
from modelgen.file_writing import replaced, write_file
from modelgen.report.run_record import COLUMNS, Array, Record
from modelgen.runtime.by_name import ByName

FORMATS = (".npz", ".csv")


def check_suffix(path: Path, formats: Sequence[str]) -> None:
    """Refuses a file whose suffix names none of the formats."""
    if path.suffix not in formats:
        found, allowed = f"no known format {path.suffix!r}", f"allowed are {', '.join(formats)}"
        raise ModelgenError(str(path), found, allowed, "give one of these suffixes")


def save(record: Record, path: str | Path) -> None:
    """Write a run, what `record_of` returned; the suffix says how (.npz or .csv).

    Raises ModelgenError for another suffix, what is no such run, or a file that cannot be written: an older
    one is then as it was.
    """
    expect("save", record, Record)
    path = path_of("save", path)
    check_suffix(path, FORMATS)
    if path.suffix == ".csv":
        _save_csv(record, path)
    else:
        write_file(path, run_bytes(record))


def missing_run(path: Path) -> ModelgenError:
    """The error of a path with no file of a run."""
    return ModelgenError(path.name, "no such file", "", "run `modelgen simulate SCENE --out` first")


def load(path: str | Path) -> Record:
    """Read a run from .npz; ModelgenError if the file is not one."""
    path = path_of("load", path)
    place = path.name or str(path)
    if path.suffix == ".csv":
        raise ModelgenError(
            place,
            "a CSV file has neither the contact points nor the surfaces of a run",
            "a .npz file has both",
            "write one with `modelgen simulate SCENE --out run.npz`",
        )
    try:
        with np.load(path, allow_pickle=False) as stored:
            if str(stored["digest"]) != _digest({name: stored[name] for name in stored.files}):
                raise ValueError("its content is not what was written")
            names = json.loads(str(stored["names"]))
            return Record(
                columns=ByName({name: stored[name] for name in COLUMNS}, "column"),
                body_names=tuple(names["bodies"]),
                contact_names=tuple(names["contacts"]),
                pairs=stored["pairs"],
                meshes={key[5:]: stored[key] for key in stored.files if key.startswith("mesh_")},
                summary=ByName(json.loads(str(stored["summary"])), "summary"),
                joint_names=tuple(names["joints"]),
                coordinate_names=tuple(names["coordinates"]),
                sensor_names=tuple(names["sensors"]),
                patch_names=tuple(names["patches"]),
                shares=tuple((patch, pair) for patch, pair in names["shares"]),
                faces={key[5:]: stored[key] for key in stored.files if key.startswith("face_")},
                scene=json.loads(str(stored["scene"])) if "scene" in stored.files else None,
            )
    except FileNotFoundError:
        raise missing_run(path) from None
    except Exception:  # of zipfile, zlib, NumPy and json: whatever they raise, it is no such file
        raise ModelgenError(
            place,
            "not a run of modelgen, or damaged",
            "a .npz file that `modelgen simulate --out` wrote",
            "write it anew",
        ) from None


def run_bytes(record: Record) -> bytes:
    """The content of the file .npz of a run."""
    names = {
        "bodies": record.body_names,
        "contacts": record.contact_names,
        "joints": record.joint_names,
        "coordinates": record.coordinate_names,
        "sensors": record.sensor_names,
        "patches": record.patch_names,
        "shares": record.shares,
    }
    meshes = {f"mesh_{key}": mesh for key, mesh in record.meshes.items()}
    faces = {f"face_{key}": face for key, face in record.faces.items()}
    texts = {"names": json.dumps(names), "summary": json.dumps(record.summary)}
    texts |= {} if record.scene is None else {"scene": json.dumps(record.scene)}
    arrays: dict[str, Array] = {**record.columns, **meshes, **faces, "pairs": record.pairs}
    arrays |= {key: np.array(text) for key, text in texts.items()}
    digest = np.array(_digest(arrays))
    file = io.BytesIO()
    np.savez_compressed(file, allow_pickle=False, **arrays, digest=digest)
    return file.getvalue()


def _digest(arrays: Mapping[str, Array]) -> str:
    """SHA-256 (hex) of names, types, shapes and values of all arrays but the digest itself."""
    digest = hashlib.sha256()
    for name in sorted(arrays.keys() - {"digest"}):
        values = np.asarray(arrays[name])
        digest.update(f"{name}:{values.dtype.str}:{values.shape}:".encode())
        digest.update(np.ascontiguousarray(values).tobytes())
    return digest.hexdigest()


def _save_csv(record: Record, path: Path) -> None:
    header, table = _table(record)
    with replaced(path) as scratch, scratch.open("w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file)
        writer.writerow(header)
        writer.writerows([repr(float(value)) for value in row] for row in table)


_AXES = {1: ("",), 3: ("_x", "_y", "_z")}


def _table(record: Record) -> tuple[list[str], Array]:
    """One row a sample: t; p, quaternion, v, w of each body; force, gap of each contact, and friction,
    torque and slip where one has friction; force and centre of pressure of each patch that rested, and where
    one has friction that, its torque, slip and spin; the force on each pair of a patch of several; force,
    torque of each joint, and coordinates; sensors; energy, work."""
    columns = record.columns
    header, parts = ["t"], [columns["t"][:, None]]
    vectors = (("p", "xyz"), ("quaternion", "wxyz"), ("v", "xyz"), ("w", "xyz"))
    for i, body in enumerate(record.body_names):
        for name, axes in vectors:
            if len(columns["t"]) == 0 or not np.isnan(columns[name][:, i]).all():
                header += [f"{body}.{name}_{axis}" for axis in axes]
                parts.append(columns[name][:, i])
    for k, contact in enumerate(record.contact_names):
        header += [f"{contact}.force", f"{contact}.gap"]
        parts += [columns["force"][:, k : k + 1], columns["gap"][:, k : k + 1]]
        for name in ("friction", "contact_torque", "slip") if record.has_friction else ():
            header += [f"{contact}.{name.removeprefix('contact_')}_{axis}" for axis in "xyz"]
            parts.append(columns[name][:, k])
    for patch in record.rested:
        header += [f"{record.patch_names[patch]}.{name}" for name in ("force", "x", "y", "z")]
        mine = columns["patch"] == patch
        parts.append(np.where(mine, columns["patch_force"], 0.0).sum(axis=1, keepdims=True))
        present = np.where(mine[..., None], columns["patch_point"], 0.0).sum(axis=1)
        parts.append(np.where(mine.any(axis=1, keepdims=True), present, np.nan))
        for name in ("friction", "torque", "slip", "spin") if record.has_friction else ():
            values = columns[f"patch_{name}"].reshape(*mine.shape, -1)
            header += [f"{record.patch_names[patch]}.{name}{axis}" for axis in _AXES[values.shape[2]]]
            parts.append(np.where(mine[..., None], values, 0.0).sum(axis=1))
        for k, (of, pair) in enumerate(record.shares):
            if of == patch:
                header.append(f"{record.patch_names[patch]}.{pair}.force")
                parts.append(columns["patch_share"][:, k : k + 1])
    for k, joint in enumerate(record.joint_names):
        for name in ("force", "torque"):
            header += [f"{joint}.{name}_{axis}" for axis in "xyz"]
            parts.append(columns[f"joint_{name}"][:, k])
    header += record.coordinate_names
    parts += [columns["coordinates"]] if record.coordinate_names else []
    header += record.sensor_names
    parts += [columns["sensors"]] if record.sensor_names else []
    parts += [columns["energy"][:, None], columns["work"][:, None]]
    return [*header, "energy", "work"], np.hstack(parts)
