"""MJCF and URDF files of a folder, imported and run: `python -m tests.benchmarks.public_models FOLDER`.

Each file is imported in a process of its own, as a user does; where parts are refused by name, it is
imported once more without them. What comes out is run to its end. A table row a file; what is done already
is read from `--out`.
"""

from __future__ import annotations

import argparse
import json
import re
import subprocess
import sys
import tempfile
import time
from pathlib import Path
from typing import Any

COLUMNS = ("file", "import", "bodies", "joints", "contacts", "run", "trusted", "s", "told")
LIMIT = 300.0  # s, of an import or a run


def command(folder: Path, *words: str) -> tuple[int, str, str]:
    """Exit code (124 beyond the limit), standard output and error of a command of modelgen in a folder."""
    call = [sys.executable, "-m", "modelgen", *words]
    try:
        done = subprocess.run(call, cwd=folder, capture_output=True, text=True, timeout=LIMIT, check=False)
    except subprocess.TimeoutExpired:
        return 124, "", f"longer than {LIMIT:g} s"
    return done.returncode, done.stdout, done.stderr.strip()


def imported(path: Path, scene: Path) -> dict[str, Any]:
    """The import of a file; of one that is refused, that without what is named."""
    code, out, error = command(scene.parent, "import", str(path), "--out", str(scene), "--json")
    row: dict[str, Any] = {"import": "loads" if code == 0 else f"exit {code}"}
    if code == 2:
        row |= {"import": "refused by name", "told": re.sub(r"\S*/", "", error.split(";")[0])}
        parts = re.search(r"--without (\S+?),? or", error)
        if parts:
            row["import"] = f"refused; loads without {parts[1]}"
            code, out, error = command(
                scene.parent, "import", str(path), "--out", str(scene), "--json", "--without", parts[1]
            )
            if code:
                row |= {"import": "refused by name", "told": re.sub(r"\S*/", "", error)}
    if code == 0:
        facts = json.loads(out)
        row["notes"] = {key: facts[key] for key in ("approximated", "left_out")}
    return row


def ran(scene: Path) -> dict[str, Any]:
    """The scene that was written, run to its end."""
    from modelgen import read

    what = read(scene)
    counts: dict[str, Any] = {
        "bodies": len(what.bodies),
        "joints": len(what.joints),
        "contacts": len(what.contacts),
    }
    begun = time.process_time(), time.perf_counter()
    code, out, error = command(scene.parent, "simulate", str(scene), "--accuracy", "fast", "--json")
    counts["s"] = round(time.perf_counter() - begun[1], 1)
    if not out:
        return counts | {"run": f"exit {code}", "run_told": error}
    facts = json.loads(out)
    return counts | {"run": facts["outcome"], "trusted": facts["trusted"], "t": facts.get("t_end")}


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("folder", type=Path)
    parser.add_argument("--files", nargs="*", help="paths below the folder; default: all .xml and .urdf")
    parser.add_argument("--out", type=Path, help="file of results, a JSON object a line")
    given = parser.parse_args()
    names = given.files or sorted(
        str(path.relative_to(given.folder))
        for end in ("xml", "urdf")
        for path in given.folder.rglob(f"*.{end}")
    )
    known = {}
    if given.out and given.out.exists():
        known = {row["file"]: row for row in map(json.loads, given.out.read_text().splitlines())}
    rows = []
    for name in names:
        row = known.get(name)
        if row is None:
            with tempfile.TemporaryDirectory() as folder:
                scene = Path(folder) / f"{Path(name).stem}.toml"
                row = {"file": name, **imported((given.folder / name).resolve(), scene)}
                if scene.exists():
                    row |= ran(scene)
            if given.out:
                with given.out.open("a") as file:
                    file.write(json.dumps(row) + "\n")
        rows.append(row)
        print(" | ".join(str(row.get(column, "")) for column in COLUMNS), flush=True)
    loaded = sum("loads" in row["import"] for row in rows)
    print(
        f"{len(rows)} files: {loaded} load, {sum(row.get('run') == 'done' for row in rows)} run to their end"
    )


if __name__ == "__main__":
    main()
