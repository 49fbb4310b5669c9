"""A compiled library, its manifest and its build record: loaded, checked, called with exact shapes."""

from __future__ import annotations

import ctypes
from collections.abc import Mapping
from copy import copy
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from modelgen.codegen.built_files import is_sealed
from modelgen.codegen.manifest import INSTANCE, STRUCTURE, BuildRecord, Json, Manifest, record_name
from modelgen.errors import LibraryError, path_of
from modelgen.name_suggestions import nearest

Array = np.ndarray[Any, Any]

DTYPES: Mapping[str, type[np.floating[Any]]] = {
    "double": np.float64,
    "float": np.float32,
    "long double": np.longdouble,
}
REAL_FLAGS: Mapping[str, tuple[str, ...]] = {
    "double": (),
    "float": ("-DMG_REAL_FLOAT",),
    "long double": ("-DMG_REAL_LONG",),
}


def kernel_table(cdll: ctypes.CDLL) -> int:
    """The address of the mg_kernels of a loaded library (kernels.h)."""
    cdll.mg_kernel_table.restype = ctypes.c_void_p
    return int(cdll.mg_kernel_table())


class Library:
    """The functions of one built scene: what the manifest lists, in the file that the record names.

    Raises LibraryError when the file is missing, damaged, built by another user, stale, or not what manifest
    and record say. What this user did not build is not loaded.
    """

    def __init__(self, manifest: Manifest, record: BuildRecord, folder: Path) -> None:
        self.manifest = manifest
        self.record = record
        self.path = path = folder / record.file
        self.real = record.real
        if self.real not in DTYPES:
            raise LibraryError(
                str(path), f"real type {self.real!r}", f"allowed: {', '.join(DTYPES)}", "build again"
            )
        self.dtype = np.dtype(DTYPES[self.real])
        if not path.is_file():
            raise LibraryError(str(path), "there is no such file", "", "build again")
        if not is_sealed(path):
            found = "it is damaged, or no build of yours wrote it, and is not loaded"
            raise LibraryError(str(path), found, "", "build again")
        try:
            self.cdll = ctypes.CDLL(str(path))
        except OSError as error:
            remedy = "build in a folder from which programs may run"
            raise LibraryError(str(path), f"it cannot be loaded: {error}", "", remedy) from None
        self.check()

    @classmethod
    def load(cls, folder: str | Path, real: str = "double") -> Library:
        """The library over one real type that was built last into a folder."""
        folder = path_of("Library.load", folder)
        if not isinstance(real, str) or real not in DTYPES:
            allowed = ", ".join(DTYPES)
            raise LibraryError("Library.load: real", repr(real), allowed, nearest(real, DTYPES))
        manifest, record = folder / STRUCTURE, folder / record_name(real)
        texts = _text(manifest), _text(folder / INSTANCE), _text(record)
        try:
            values = (
                Manifest.from_json(*texts[:2], str(manifest)),
                BuildRecord.from_json(texts[2], str(record)),
            )
            return cls(*values, folder)
        except (ArithmeticError, AttributeError, LookupError, TypeError, ValueError) as error:
            found = f"manifest or record are damaged: {error!r}"
            raise LibraryError(str(folder), found, "", "build again") from None

    def check(self) -> None:
        """Raises LibraryError unless manifest, record and library agree."""
        try:
            self.cdll.mg_hash.restype = ctypes.c_char_p
            abi, key = self.cdll.mg_abi(), self.cdll.mg_hash().decode()
            size = self.cdll.mg_real_size()
        except AttributeError:
            raise LibraryError(str(self.path), "it is not a library of modelgen", "", "build again") from None
        manifest, record = self.manifest, self.record
        for what, found, allowed in (
            ("ABI", abi, manifest.abi),
            ("hash of its kinds", record.kinds_hash, manifest.kinds_hash),
            ("hash", key, record.hash),
            ("hash in the file name", self.path.stem.rpartition("-")[2], record.hash[:16]),
            ("size of the real type", size, self.dtype.itemsize),
        ):
            if found != allowed:
                raise LibraryError(
                    str(self.path),
                    f"{what} {found}",
                    f"its manifest and record say {allowed}",
                    "it is stale: build again",
                )

    def with_instance(self, instance: Json) -> Library:
        """The same functions with other numbers, for an instance over the same kinds."""
        other = copy(self)
        other.manifest = replace(self.manifest, instance=instance)
        return other

    def kernel(self, name: str) -> Kernel:
        """The kernel of that name; LibraryError if the manifest has none."""
        if not isinstance(name, str) or name not in self.manifest.functions:
            known = self.manifest.functions
            raise LibraryError(
                str(self.path), f"no kernel {name!r}", f"kernels: {', '.join(known)}", nearest(name, known)
            )
        return Kernel(self, name)


class Kernel:
    """One kernel: takes arrays of the manifest's shapes and the library's type, returns new arrays.

    `unused` names the poses and twists, or parts of them, that change no result: "rotation of pose_f" of a
    sphere about its centre of mass that touches without friction.
    """

    def __init__(self, library: Library, name: str) -> None:
        entry = library.manifest.functions[name]
        self.name = name
        self.dtype = library.dtype
        self.inputs = [(argument["name"], tuple(argument["shape"])) for argument in entry["inputs"]]
        self.outputs = [(argument["name"], tuple(argument["shape"])) for argument in entry["outputs"]]
        self.unused: tuple[str, ...] = tuple(entry.get("unused", ()))
        self._function = library.cdll[name]
        self._function.argtypes = [ctypes.c_void_p] * 4 + [ctypes.c_int]

    def __call__(self, *arrays: Array) -> tuple[Array, ...]:
        """Raises LibraryError for a wrong number of arrays, a wrong shape or a wrong type."""
        if len(arrays) != len(self.inputs):
            names = ", ".join(name for name, _ in self.inputs)
            raise LibraryError(self.name, f"{len(arrays)} arguments", f"it takes {len(self.inputs)}: {names}")
        for array, (name, shape) in zip(arrays, self.inputs, strict=True):
            self._check(array, name, shape)
        results = tuple(np.zeros(shape, dtype=self.dtype) for _, shape in self.outputs)
        self._function(_pointers(arrays), _pointers(results), None, None, 0)
        return results

    def _check(self, array: Array, name: str, shape: tuple[int, ...]) -> None:
        exact = isinstance(array, np.ndarray) and array.dtype == self.dtype and array.shape == shape
        if not exact or not array.flags.c_contiguous:
            found = f"{array.dtype} {array.shape}" if isinstance(array, np.ndarray) else type(array).__name__
            raise LibraryError(
                f"{self.name}: {name}",
                found,
                f"a contiguous array of {self.dtype} with shape {shape} is needed",
            )


def _text(path: Path) -> str:
    try:
        return path.read_text(encoding="utf-8")
    except OSError as error:
        raise LibraryError(str(path), f"it cannot be read: {error.strerror}", "", "build first") from None
    except UnicodeDecodeError:
        raise LibraryError(str(path), "it is damaged: no text in UTF-8", "", "build again") from None


def _pointers(arrays: tuple[Array, ...]) -> ctypes.Array[ctypes.c_void_p]:
    return (ctypes.c_void_p * max(1, len(arrays)))(*(array.ctypes.data for array in arrays))
