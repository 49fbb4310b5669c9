"""Scene files with one mistake each, as people make them, and what the answer must say: place, finding,
remedy.

`python -m tests.benchmarks.mistakes` prints them with their answers.
"""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

GOOD = """gravity = [0.0, 0.0, -9.81]

[run]
until = 1.0
accuracy = "balanced"

[[body]]
name = "table"
motion = "fixed"
shape = { kind = "plane" }

[[body]]
name = "can"
density = 1000.0
shape = { kind = "cylinder", radius = 0.03, length = 0.1 }
position = [0.0, 0.0, 0.2]
rpy = [0.1, 0.2, 0.0]
velocity = [0.5, 0.0, 0.0]

[[contact]]
between = ["can", "table"]
restitution = 0.5
friction = 0.3
"""
BALL = """
[[body]]
name = "ball"
density = 500.0
shape = { kind = "sphere", radius = 0.05 }
position = [1.0, 0.0, 0.5]
"""
JOINT = BALL + '\n[[joint]]\nkind = "revolute"\nbetween = ["ball", "table"]\n'
CAN = 'kind = "cylinder", radius = 0.03, length = 0.1'


class Mistake(NamedTuple):
    name: str
    text: str
    words: tuple[str, ...]  # of the answer


def change(name: str, old: str, new: str, *words: str) -> Mistake:
    """A text of the good scene replaced by another, wherever it stands."""
    assert old in GOOD, old
    return Mistake(name, GOOD.replace(old, new), words)


def addition(name: str, more: str, *words: str) -> Mistake:
    return Mistake(name, GOOD + more, words)


def force(name: str, expression: str, *words: str) -> Mistake:
    return addition(
        name, f'\n[[force]]\nbody = "can"\nforce = ["{expression}", "0", "0"]\n', "force[0].force[0]", *words
    )


REFUSED = (
    # the language of the file
    addition("a table twice", "\n[run]\nsamples = 100\n", "line 25", "[run] is written twice", "merge"),
    change("single brackets", "[[body]]", "[body]", "line 12", "[body] is", "write [[body]] for each"),
    change("one contact as a table", "[[contact]]", "[contact]", "contact: a table", "write [[contact]]"),
    change("contacts in a list", "[[contact]]", "[[contacts]]", "contacts: a list", "write [[contact]]"),
    change("a plural", "[[body]]", "[[bodies]]", "unknown key 'bodies'", "did you mean 'body'?"),
    change("a decimal comma", "1000.0", "1000,5", "line 14", "1000,5", "write 1000.5"),
    change(
        "decimal commas in a list", "[0.0, 0.0, 0.2]", "[0,0, 0,0, 0,2]",
        "body[1].position", "a list of 6", "write [0.0, 0.0, 0.2]",
    ),
    change("a comma in braces", "0.03", "0,03", "line 15", "0,03 with a decimal comma", "write 0.03"),
    change("a comma and an exponent", "1000.0", "7,85e3", "line 14", "7,85e3", "write 7.85e3"),
    change("a comma in a text", "1000.0", '"1000,5"', "body[1].density", "decimal comma", "write 1000.5"),
    change("one decimal comma in a list", "0.0, 0.2]", "0.0, 0,2]", "a list of 4", "write [0.0, 0.0, 0.2]"),
    change("a unit", "1000.0", "1000 kg/m^3", "line 14", "'kg/m^3'", "SI units"),
    change("no quotation marks", '"can"', "can", "line 13", "can", 'write "can"'),
    change("half of the quotation marks", 'name = "can"', 'name = "can', "line 13", "closing quotation mark"),
    change("True", "until = 1.0", "estimate = True", "line 4", "True", "write true"),
    change("a colon", "until = 1.0", "until: 1.0", "line 4", "':'", "write key = value"),
    change("a semicolon", "until = 1.0", "until = 1.0;", "line 4", "';'", "one key = value on a line"),
    change("an open list", "0.2]\nrpy", "0.2\nrpy", "line 17", "closing bracket", "[a, b, c]"),
    change("no commas", "[0.0, 0.0, 0.2]", "[0.0 0.0 0.2]", "line 16", "comma between", "[a, b, c]"),
    change("an open brace", "length = 0.1 }", "length = 0.1", "line 15", "closing brace", "{ a = 1, b = 2 }"),
    change("a comment of C", "[run]", "// the run\n[run]", "line 3", "'// the run'", "comments with #"),
    Mistake("JSON", '{"body": []}', ("line 1", "no JSON")),
    Mistake("YAML", "gravity:\n  - 0\n", ("line 1", "':'", "write key = value")),
    Mistake("nothing", "# to be written\n", ("an empty file", "add a [[body]]")),
    Mistake("no body", "[run]\nuntil = 1.0\n", ("'body' is missing", "add a [[body]]")),
    # bodies and shapes
    addition("two bodies of one name", BALL.replace("ball", "can"), "body[2]", "'can'", "another name"),
    addition("a body without a name", BALL.replace('name = "ball"\n', ""), "body[2]", "'name'", "add name"),
    addition("a space in a name", BALL.replace("ball", "my ball"), "body[2].name", "'my ball'", "letters"),
    change("a diameter", "radius = 0.03", "diameter = 0.06", "'diameter'", "'radius', half the diameter?"),
    change("a short word", "radius = 0.03", "r = 0.03", "body[1].shape", "'r'", "did you mean 'radius'?"),
    change("a height", "length", "height", "unknown key 'height'", "did you mean 'length'?"),
    change("a length forgotten", ", length = 0.1", "", "body[1].density", "no finite solid", "add length"),
    change("a negative radius", "0.03", "-0.03", "body[1].shape.radius", "-0.03", "a positive number"),
    change("a unit in a text", "0.03", '"30mm"', "shape.radius", "'mm'", "without its unit", "in m"),
    change("a unit with a power", "1000.0", '"1000 kg/m^3"', "density", "'kg/m^3'", "without its unit"),
    change("a shape misspelt", '"cylinder"', '"cilinder"', "shape.kind", "'cilinder'", "'cylinder'?"),
    change("an everyday word", '"cylinder"', '"can"', "shape.kind", "'can'", "did you mean 'disc'?"),
    change("a shape as a text", '{ kind = "plane" }', '"plane"', "body[0].shape", 'write { kind = "plane"'),
    change("a type", 'kind = "cylinder"', 'type = "cylinder"', "'kind' is missing", "kind in place of type"),
    change("edges of a box", CAN, 'kind = "box", x = 1, y = 1, z = 1', "'x'", "'size', [x, y, z]?"),
    change("one edge of a box", CAN, 'kind = "box", size = 0.1', "shape.size", "the number 0.1", "[x, y, z]"),
    change("radii", CAN, 'kind = "ellipsoid", radii = [1, 2, 3]', "'radii'", "did you mean 'semi_axes'?"),
    change("a shape without a mass", "density = 1000.0\n", "", "body[1]", "without mass", "or density"),
    change("a mass without inertia", "density", "mass", "body[1]", "without inertia", "add inertia"),
    change("a negative mass", "density = 1000.0", "mass = -1", "body[1].mass", "-1", "a positive number"),
    change("a mass of 0", "density = 1000.0", "mass = 0", "body[1].mass", "0", "a positive number"),
    change("mass and density", "1000.0", "1000.0\nmass = 1.0", "'mass' and 'density'", "remove the others"),
    change(
        "an inertia of no body", "density = 1000.0", "mass = 1.0\ninertia = [0.1, 0.1, 0.5]",
        "body[1].inertia", "0.1, 0.1, 0.5", "none may exceed the sum", "check the units",
    ),
    change(
        "six moments", "density = 1000.0", "mass = 1\ninertia = [1, 1, 1, 0, 0, 0]",
        "body[1].inertia", "a list of 6", "write inertia = [Ixx, Iyy, Izz]",
    ),
    change("two coordinates", "[0.0, 0.0, 0.2]", "[0.0, 0.2]", "position", "a list of 2", "write [x, y, z]"),
    change("a speed", "velocity = [0.5, 0.0, 0.0]", "velocity = 0.5", "velocity", "0.5", "write [x, y, z]"),
    change("omega", "velocity", "omega", "unknown key 'omega'", "did you mean 'angular_velocity'?"),
    change("a capital", "density", "Density", "unknown key 'Density'", "did you mean 'density'?"),
    change("a colour", "1000.0", '1000.0\ncolor = "red"', "unknown key 'color'", "leave it out"),
    change("degrees with their unit", "[0.1, 0.2, 0.0]", '["45 deg", 0, 0]', "rpy[0]", '"45*pi/180"'),
    change("two orientations", "rpy", "quaternion = [1, 0, 0, 0]\nrpy", "together", "remove the others"),
    change("static = true", 'motion = "fixed"', "fixed = true", "unknown key 'fixed'", 'motion = "fixed"'),
    change("a moving fixed body", '"fixed"', '"fixed"\nvelocity = [1, 0, 0]', "is 'fixed'", "'dynamic'"),
    change("driven without a path", '"fixed"', '"driven"', "body[0]", "'path' is missing", "add path"),
    # contacts
    change("a partner misspelt", '"can", "table"', '"can", "tabel"', "contact[0]", "'tabel'", "'table'?"),
    change("a partner that is none", '"can", "table"', '"can", "floor"', "'floor'", "bodies: table, can"),
    change("a body with itself", '"can", "table"', '"can", "can"', "itself", "two different bodies"),
    addition("a contact twice", '\n[[contact]]\nbetween = ["table", "can"]\n', "contact[1]", "a second time"),
    change("three partners", '"can", "table"', '"can", "table", "can"', "a list of 3", '["one", "other"]'),
    change("partners in a text", '["can", "table"]', '"can-table"', "contact[0].between", '["one", "other"]'),
    change("bodies of a contact", "between", "bodies", "unknown key 'bodies'", "did you mean 'between'?"),
    change("friction in words", "0.3\n", '"high"\n', "contact[0].friction", "'high'", "write a number"),
    change("negative friction", "friction = 0.3", "friction = -0.3", "friction", "-0.3", "from 0 to"),
    change("two coefficients", "friction = 0.3", "friction = [0.4, 0.3]", "a list of 2", "static = ..."),
    change("friction of a body", "1000.0", "1000.0\nfriction = 0.3", "body[1]", "belongs to a [[contact]]"),
    change("mu", "friction", "mu", "contact[0]", "unknown key 'mu'", "did you mean 'friction'?"),
    change("a bounce that gains", "0.5\nfriction", "2\nfriction", "contact[0].restitution", "from 0 to 1"),
    # joints and loads
    addition("a joint of one body", JOINT.replace(', "table"', ""), "joint[0].between", "a list of 1"),
    addition("the place of a joint", f"{JOINT}at = [0, 0, 1]\n", "'at'", "did you mean 'position'?"),
    addition("the axis of a joint", f"{JOINT}axis = [0, 0, 1]\n", "'axis'", "z of its frame", "rpy"),
    addition("a hinge", JOINT.replace("revolute", "hinge"), "joint[0].kind", "did you mean 'revolute'?"),
    addition("limits turned round", f"{JOINT}limits = [1.0, -1.0]\n", "joint[0].limits", "the least first"),
    addition(
        "a spring on a joint without coordinate",
        JOINT.replace("revolute", "spherical") + "stiffness = 1.0\n",
        "joint[0]", "'stiffness' where kind is 'spherical'", "'revolute' or 'prismatic'",
    ),
    addition(
        "the length of a spring",
        f'{BALL}\n[[spring]]\nbetween = ["ball", "can"]\nstiffness = 1.0\nlength = 1.0\n',
        "spring[0]", "unknown key 'length'", "did you mean 'rest_length'?",
    ),
    addition(
        "a force on a fixed body", '\n[[force]]\nbody = "table"\nforce = [1, 0, 0]\n',
        "force[0].body", "'table', which is fixed", "name another body",
    ),
    force("an unknown name", "stiff*x", "unknown name 'stiff'", "known names: qw"),
    force("a capital function", "Sin(t)", "unknown function 'Sin'", "did you mean 'sin'?"),
    force("numpy", "np.sin(t)", "not a function", "write sin(...)"),
    force("a caret", "t^2", "'^'", "write ** for a power"),
    force("a product without its sign", "2t", "a product", "write 2*t"),
    force("an open bracket", "sin(t", "a bracket without its ')'", "add )"),
    force("a condition", "1 if t < 1 else 0", "'<'", "use max, min, abs or sign"),
    # the run and the world
    change("gravity as a number", "[0.0, 0.0, -9.81]", "9.81", "gravity", "9.81", "write [0.0, 0.0, -9.81]"),
    change("gravity of the run", "[run]", "[run]\ngravity = [0, 0, 0]", "'gravity'", "top of the file"),
    change("an unknown accuracy", '"balanced"', '"medium"', "run.accuracy", "'medium'", "fast, balanced"),
    change("a tolerance as accuracy", '"balanced"', "1e-8", "run.accuracy", "1e-08", "tolerance = ..."),
    change("no time", "until = 1.0", "until = 0", "run.until", "the number 0", "a positive number"),
    change("time with its unit", "until = 1.0", 'until = "1s"', "run.until", "'s'", "without its unit"),
    change("another word for the end", "until", "t_end", "run", "'t_end'", "did you mean 'until'?"),
    change(
        "a step longer than the run", 'accuracy = "balanced"', 'method = "rk4"\nstep = 2.0',
        "run.step", "2 s, longer than the run of 1 s", "shorten it",
    ),
    change("a step alone", 'accuracy = "balanced"', "step = 0.001", "run.step", 'method = "rk4"'),
    change("an unknown method", 'accuracy = "balanced"', 'method = "euler"', "run.method", "rk4"),
)  # fmt: skip

WARNED = (
    change("degrees", "[0.1, 0.2, 0.0]", "[0.0, 90.0, 0.0]", "body[1].rpy", "90 rad", '"90*pi/180"'),
    change("few degrees", "[0.1, 0.2, 0.0]", "[10, 0, 0]", "body[1].rpy", "10 rad", '"10*pi/180"'),
    change(
        "degrees about an axis", "rpy = [0.1, 0.2, 0.0]", "axis_angle = { axis = [0, 1, 0], angle = 45 }",
        "body[1].axis_angle.angle", "45 rad", '"45*pi/180"',
    ),
    addition("limits in degrees", f"{JOINT}limits = [-90, 90]\n", "joint[0].limits", '"-90*pi/180"'),
    change("w last", "rpy = [0.1, 0.2, 0.0]", "quaternion = [0, 0, 0, 1]", "quaternion", "w, x, y, z"),
    change("gravity up", "-9.81", "9.81", "gravity points up", "write [0.0, 0.0, -9.81]"),
    change("g/cm^3", "1000.0", "1.0", "body[1].density", "1 kg/m^3", "water has 1000"),
)  # fmt: skip

FILES = {  # what is written (None: nothing), what is read, what the answer must say
    "a name mistyped": ("drop.toml", "dorp.toml", ("no such file", "did you mean 'drop.toml'?")),
    "an ending forgotten": ("drop.toml", "drop", ("no such file", "did you mean 'drop.toml'?")),
    "a name like no other": ("drop.toml", "gearbox.toml", ("no such file", "check the path")),
    "a folder that is not there": (None, "no/drop.toml", ("no such file", "there is no folder", "no'")),
    "a folder": (None, ".", ("it is a folder", "give the path of a file")),
}
ENCODED = {  # text and encoding of a file
    "UTF-16": (GOOD, "utf-16", ("line 1 is not UTF-8", "save it as UTF-8")),
    "Latin-1": (f"# one\n# zwölf\n{GOOD}", "latin-1", ("line 2 is not UTF-8", "save it as UTF-8")),
}


def written(folder: Path) -> Iterator[tuple[str, Path, tuple[str, ...]]]:
    """Mistakes with files: each with the path that is read, after what it needs has been written."""
    for name, (made, asked, words) in FILES.items():
        if made is not None:
            (folder / made).write_text(GOOD, encoding="utf-8")
        yield name, folder / asked, words
    for name, (text, encoding, words) in ENCODED.items():
        path = folder / f"{name}.toml"
        path.write_bytes(text.encode(encoding))
        yield name, path, words
