"""Files that a command reads."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path

from modelgen.errors import ModelgenError


def check_inputs(values: Iterable[object]) -> None:
    """Raise ModelgenError for a path, or one in a list of paths, where no file is."""
    for value in values:
        for path in value if isinstance(value, list) else [value]:
            if isinstance(path, Path) and _is_missing(path):
                raise _missing(path)


def _is_missing(path: Path) -> bool:
    """Whether nothing has this path; False of what is no path."""
    try:
        return not path.exists()
    except (OSError, ValueError):
        return False


def _missing(path: Path) -> ModelgenError:
    from modelgen.report.run_files import missing_run
    from modelgen.scene.read import no_such_file

    return missing_run(path) if path.suffix == ".npz" else no_such_file(path)
