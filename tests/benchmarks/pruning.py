"""What each decision to leave something out saves, over the shipped scenes: instructions and bytes.

`python -m tests.benchmarks.pruning [--machine] [SCENE ...]` derives each scene as it stands and with each
decision undone. Bytes are those of C text; with --machine both are compiled, and bytes are those of the
library's text section by `size`.
"""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path
from tempfile import TemporaryDirectory

from modelgen import build, derive, emit, read, require
from modelgen.report.savings_by_decision import DECISIONS, Saving, savings_of
from modelgen.scene.scene_types import Scene
from tests.running import NAMES, SCENES

WHOLE = ("no derivatives", "planar motion")  # of the right-hand side as one function: no bytes


def machine_bytes(scene: Scene, folder: Path) -> int:
    """Of the text section of the scene's library."""
    library = build(emit(derive(require(scene)).of_kinds()), folder=folder)
    answer = subprocess.run(["size", library.path], capture_output=True, text=True, check=True)
    return int(answer.stdout.splitlines()[1].split()[0])


def compiled(scene: Scene, saving: Saving, folder: Path) -> int:
    """Bytes of machine code that a decision saves, or would save."""
    undone = DECISIONS[saving.decision](require(scene))
    assert undone is not None
    own = machine_bytes(scene, folder / scene.name)
    other = machine_bytes(undone[1], folder / f"{scene.name}.{saving.decision.replace(' ', '_')}")
    return other - own if saving.taken else own - other


def cells(scene: Scene, machine: Path | None) -> list[str]:
    """A scene's sizes, and what each decision saves: instructions / bytes; in brackets what is not taken."""
    found = {saving.decision: saving for saving in savings_of(derive(require(scene)))}
    own = next(iter(found.values())).size
    row = [scene.name, f"{own.instructions} / {own.bytes}"]
    for decision in (*DECISIONS, *WHOLE):
        saving = found.get(decision)
        if saving is None:
            row.append("")
            continue
        saved = saving.as_json()["saved"]
        text = str(saved["instructions"])
        if decision not in WHOLE:
            text += f" / {saved['bytes'] if machine is None else compiled(scene, saving, machine)}"
        row.append(text if saving.taken else f"({text})")
    return row


def main() -> None:
    names = [name for name in sys.argv[1:] if name != "--machine"] or NAMES
    head = ["scene", "instructions / bytes", *DECISIONS, *WHOLE]
    print(f"| {' | '.join(head)} |\n|{' --- |' * len(head)}")
    with TemporaryDirectory() as folder:
        machine = Path(folder) if "--machine" in sys.argv else None
        for name in names:
            print(f"| {' | '.join(cells(read(SCENES / f'{name}.toml'), machine))} |", flush=True)


if __name__ == "__main__":
    main()
