"""The functions of this folder as CasADi functions; needs CasADi and nothing else.

from load import load

functions = load()
print(functions["NAME"])
"""

import json
from pathlib import Path

import casadi as ca


def load(folder: Path = Path(__file__).parent) -> dict[str, ca.Function]:
    """The functions by name: compiled kernels, and composed functions where the scene has some."""
    facts = json.loads((Path(folder) / "functions.json").read_text(encoding="utf-8"))
    library = str(Path(folder) / facts["library"])
    functions = {name: ca.external(name, library) for name in facts["kernels"]}
    for name, file in facts["composed"].items():
        functions[name] = ca.Function.deserialize((Path(folder) / file).read_text(encoding="utf-8"))
    return functions


if __name__ == "__main__":
    for function in load().values():
        print(function)
