"""The folder of a sweep: its plan, the table in Parquet, and whole runs.

A chunk of rows becomes a file in `parts` by renaming, so that it is there whole or not at all; when all runs
are done, the parts become one file. What is there after an interruption is what is done.
"""

from __future__ import annotations

import fcntl
import hashlib
import json
import os
import re
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from itertools import pairwise
from pathlib import Path
from typing import Any

from modelgen.errors import ModelgenError, install
from modelgen.file_writing import SCRATCH, remove_abandoned, write_file
from modelgen.parameter_study.rows import Row
from modelgen.parameter_study.run_queue import Span

PLAN, TABLE, PARTS, RUNS = "sweep.json", "runs.parquet", "parts", "runs"
PART = re.compile(r"(\d+)-(\d+)\.parquet")
FILES = (".csv", ".json", ".npz", ".parquet", ".xlsx")
REMEDY = "name another folder, or remove it"


def require_pyarrow() -> tuple[Any, Any]:
    """The modules pyarrow and pyarrow.parquet; ModelgenError names the extra that brings them."""
    try:
        import pyarrow
        import pyarrow.parquet
    except ImportError:
        found = "no package 'pyarrow', which writes the table"
        raise ModelgenError("sweep", found, "", install("sweep")) from None
    return pyarrow, pyarrow.parquet


class SweepFolder:
    """A folder that one sweep at a time writes."""

    def __init__(self, path: Path) -> None:
        if path.suffix in FILES and not path.is_dir():
            remedy = f"write {str(path.with_suffix(''))!r}"
            raise ModelgenError(
                str(path), "the name of a file", f"a folder, in which {TABLE} is made", remedy
            )
        self.path = path
        self._arrow, self._parquet = require_pyarrow()

    @contextmanager
    def held(self, plan: Mapping[str, Any]) -> Iterator[None]:
        """Hold the folder for a plan, which is written into a new one.

        Raises ModelgenError where the folder holds another plan or something else, or another process holds
        it.
        """
        try:
            self.path.mkdir(parents=True, exist_ok=True)
        except OSError as error:
            raise _unwritable(self.path, error) from None
        holder = os.open(self.path, os.O_RDONLY)
        try:
            try:
                fcntl.flock(holder, fcntl.LOCK_EX | fcntl.LOCK_NB)
            except OSError:
                found = "another process writes a sweep into it"
                raise ModelgenError(
                    str(self.path), found, "", "wait for it, or name another folder"
                ) from None
            try:
                self._take_up(plan)
            except OSError as error:
                raise _unwritable(self.path, error) from None
            yield
        finally:
            os.close(holder)

    def done(self) -> list[Span]:
        """The runs that are in the table."""
        if (self.path / TABLE).exists():
            return [Span(0, int(self.plan()["runs"]))]
        return [span for span, _ in self._parts()]

    def put(self, first: int, rows: Sequence[Row], files: Sequence[bytes | None]) -> None:
        """Keep a chunk: files of whole runs, then its rows."""
        for row, content in zip(rows, files, strict=True):
            if content is not None:
                write_file(self.path / RUNS / f"{row['run']:07d}.npz", content)
        self._write_table(
            self.path / PARTS / f"{first:07d}-{first + len(rows) - 1:07d}.parquet", self._table(rows)
        )

    def finish(self) -> None:
        """Join the parts to one file."""
        if not (self.path / TABLE).exists():
            self._write_table(self.path / TABLE, self._joined())
        self._remove_parts()

    def table(self) -> dict[str, list[Any]]:
        """The columns of all runs that are done, in order of the runs."""
        found: dict[str, list[Any]] = self._joined().to_pydict()
        return found

    def plan(self) -> dict[str, Any]:
        """The plan in the folder; ModelgenError where there is none."""
        try:
            plan = json.loads((self.path / PLAN).read_text(encoding="utf-8"))
        except FileNotFoundError:
            found, remedy = "no sweep is in it", "name the folder that `modelgen sweep --out` wrote"
            raise ModelgenError(str(self.path), found, "", remedy) from None
        except (ValueError, RecursionError) as error:
            raise ModelgenError(str(self.path / PLAN), f"no JSON: {error}", "", REMEDY) from None
        if not isinstance(plan, dict) or plan.pop("digest", None) != _digest(plan):
            raise ModelgenError(str(self.path / PLAN), "no plan of a sweep, or damaged", "", REMEDY)
        return plan

    def _take_up(self, plan: Mapping[str, Any]) -> None:
        """Write the plan, or compare it with that of the folder; remove what was being written."""
        if (self.path / PLAN).exists():
            _compare(self.path, self.plan(), plan)
        elif [name for name in os.listdir(self.path) if not name.startswith(SCRATCH)]:
            raise ModelgenError(str(self.path), "it holds files that are no sweep", "an empty folder", REMEDY)
        else:
            told = json.loads(json.dumps(plan))
            told["digest"] = _digest(told)
            write_file(self.path / PLAN, json.dumps(told, indent=1) + "\n")
        (self.path / PARTS).mkdir(exist_ok=True)
        for folder in (self.path, self.path / PARTS, self.path / RUNS):
            remove_abandoned(folder)
        if (self.path / TABLE).exists():
            self._remove_parts()

    def _parts(self) -> list[tuple[Span, Path]]:
        """The parts of the table, in order of the runs."""
        found = []
        for path in (self.path / PARTS).glob("*.parquet"):
            if match := PART.fullmatch(path.name):
                first, last = int(match[1]), int(match[2])
                found.append((Span(first, last - first + 1), path))
        return sorted(found)

    def _remove_parts(self) -> None:
        for _, path in self._parts():
            path.unlink()
        if (self.path / PARTS).is_dir():
            (self.path / PARTS).rmdir()

    def _schema(self) -> Any:
        types = {name: self._arrow.type_for_alias(kind) for name, kind in self.plan()["columns"].items()}
        return self._arrow.schema(list(types.items()))

    def _table(self, rows: Sequence[Row]) -> Any:
        schema = self._schema()
        columns = {name: [row.get(name) for row in rows] for name in schema.names}
        return self._arrow.table(columns, schema=schema)

    def _joined(self) -> Any:
        whole = self.path / TABLE
        if not whole.exists():
            parts = self._parts()
            tables = [self._read(path, span) for span, path in parts]
            _check_apart(self.path, [span for span, _ in parts])
            return self._arrow.concat_tables(tables) if tables else self._table([])
        return self._read(whole, Span(0, int(self.plan()["runs"])))

    def _read(self, path: Path, span: Span) -> Any:
        """The table of these runs in a file; ModelgenError where it is damaged or of other runs."""
        schema = self._schema()
        try:
            table = self._parquet.ParquetFile(  # in this thread: another that still held memory of Python at
                self._arrow.BufferReader(path.read_bytes()),  # the end of the process would abort it
                page_checksum_verification=True,
            ).read(use_threads=False)
            table = table.select(schema.names).cast(schema)
            runs = table["run"].to_pylist()
        except Exception as error:  # of pyarrow: whatever it raises, the table is damaged
            found = f"its table cannot be read: {' '.join(str(error).split())}"
            raise ModelgenError(str(self.path), found, "", REMEDY) from None
        if runs != list(range(span.first, span.first + span.size)):
            found = f"its table cannot be read: {path.name} holds other runs than those that it should"
            raise ModelgenError(str(self.path), found, "", REMEDY)
        return table

    def _write_table(self, path: Path, table: Any) -> None:
        """Write a file, from memory: pyarrow takes no name that is not UTF-8."""
        content = self._arrow.BufferOutputStream()
        self._parquet.write_table(table, content, write_page_checksum=True)
        write_file(path, content.getvalue().to_pybytes())


def _digest(plan: Mapping[str, Any]) -> str:
    """SHA-256 (hex) of a plan."""
    return hashlib.sha256(json.dumps(plan, sort_keys=True).encode()).hexdigest()


def _check_apart(path: Path, spans: Sequence[Span]) -> None:
    """Raise ModelgenError where two parts hold the same run."""
    for before, after in pairwise(spans):
        if before.first + before.size > after.first:
            found = f"its table cannot be read: two parts hold run {after.first}"
            raise ModelgenError(str(path), found, "", REMEDY)


def _compare(path: Path, own: Mapping[str, Any], plan: Mapping[str, Any]) -> None:
    """Raise ModelgenError where the plan is not that of the folder; it says in what they differ."""
    told = json.loads(json.dumps(plan))
    changed = [name for name in (*told, *own) if own.get(name) != told.get(name)]
    if changed:
        name = changed[0]
        difference = _difference(own.get(name), told.get(name))
        found = f"it holds a sweep with another {name.replace('_', ' ')}{difference}"
        raise ModelgenError(str(path), found, "the same command goes on with a sweep", REMEDY)


def _difference(own: Any, given: Any) -> str:
    """` (0.5, now 0.6)` of short values; of tables the entries that differ."""
    if isinstance(own, dict) and isinstance(given, dict):
        names = [name for name in {**own, **given} if own.get(name) != given.get(name)]
        told = "; ".join(f"{name}: {own.get(name)}, now {given.get(name)}" for name in names)
    else:
        told = f"{own}, now {given}"
    return f" ({told})" if len(told) <= 200 else ""


def _unwritable(path: Path, error: OSError) -> ModelgenError:
    return ModelgenError(str(path), f"cannot be written: {error.strerror}", "a folder", "name another one")
