"""A sound scene, and broken ones that the JSON Schema refuses as well: name, text, what the message says."""

from __future__ import annotations

TABLE = '[[body]]\nname = "table"\nmotion = "fixed"\nshape = { kind = "plane" }\n'
SHAPE = 'shape = { kind = "sphere", radius = 0.1 }\n'
MASS = "mass = 1.0\ninertia = [0.004, 0.004, 0.004]\n"
EGG = '[[body]]\nname = "egg"\n' + SHAPE + MASS
CONTACT = '[[contact]]\nbetween = ["egg", "table"]\n'
SOUND = TABLE + EGG + CONTACT


def egg(lines: str, mass: str = MASS, shape: str = SHAPE) -> str:
    """The sound scene with other lines for the egg, body[1]."""
    return TABLE + '[[body]]\nname = "egg"\n' + shape + mass + lines + "\n" + CONTACT


def shaped(text: str) -> str:
    return egg("", shape=f"shape = {{ {text} }}\n")


def chart(z: str, rest: str = "") -> str:
    return shaped(f'kind = "chart", x = "u", y = "v", z = "{z}", domain = [[-1, 1], [-1, 1]]{rest}')


Case = tuple[str, str, list[str]]

STRUCTURAL: list[Case] = [
    (
        "unit of a parameter with a control character",
        SOUND + '[[parameter]]\nname = "a"\nvalue = 1\nunit = "N\\u0001m"\n',
        ["parameter[0].unit", "control characters"],
    ),
    (
        "unit of an input on two lines",
        SOUND + '[[input]]\nname = "a"\nunit = "N\\u2028m"\n',
        ["input[0].unit", "one line of at most 40"],
    ),
    (
        "stand-in with an escape",
        egg("", shape='shape = { kind = "sphere", radius = 0.1, stands_for = "a \\u001b[31mcup" }\n'),
        ["stands_for", "control characters"],
    ),
    ("no body", "fold = true", ["'body' is missing", "add a [[body]]"]),
    ("body as one table", "[body]\nname = 'egg'\n", ["body: a table", "write [[body]]"]),
    ("no name", SOUND.replace('name = "egg"\n', ""), ["body[1]: the key 'name' is missing", "add name"]),
    ("unknown key", egg("frixion = 1"), ["body[1] (body 'egg'): unknown key 'frixion'", "allowed are"]),
    ("misspelt key", egg("positon = [0, 0, 1]"), ["'positon'", "did you mean 'position'?"]),
    ("misspelt top key", SOUND + "[rum]\nuntil = 1", ["unknown key 'rum'", "did you mean 'run'?"]),
    ("misspelt run key", SOUND + "[run]\nuntill = 1", ["run: unknown key 'untill'", "did you mean 'until'?"]),
    ("bad name", SOUND.replace('"egg"', '"the egg"'), ["body[1].name", "'the egg'", "a name is allowed"]),
    ("unknown motion", egg('motion = "dynamik"'), ["body[1].motion", "'dynamik'", "did you mean 'dynamic'?"]),
    ("mass of a fixed body", TABLE + "mass = 1.0\n", ["'mass' where motion is 'fixed'", "'dynamic'"]),
    ("path of a dynamic body", egg('path = { position = ["t", 0, 0] }'), ["'path'", "'driven'"]),
    ("driven without path", egg('motion = "driven"', mass=""), ["'path' is missing", "expressions of t"]),
    ("no kind", shaped("radius = 0.1"), ["body[1].shape", "'kind' is missing", "plane, sphere, ellipsoid"]),
    ("unknown shape", shaped('kind = "elipsoid"'), ["shape.kind", "'elipsoid'", "did you mean 'ellipsoid'?"]),
    ("another word for a box", shaped('kind = "Cube"'), ["shape.kind", "'Cube'", "did you mean 'box'?"]),
    ("another word for a sphere", shaped('kind = "ball"'), ["'ball'", "did you mean 'sphere'?"]),
    ("a height", shaped('kind = "cylinder", radius = 1, height = 2'), ["'height'", "did you mean 'length'?"]),
    (
        "a diameter",
        shaped('kind = "sphere", diameter = 2'),
        ["'diameter'", "did you mean 'radius', half the diameter?"],
    ),
    ("Greek friction", SOUND + "mu = 0.3\n", ["'mu'", "did you mean 'friction'?"]),
    ("a time step", SOUND + "[run]\ndt = 0.3\n", ["'dt'", "did you mean 'step'?"]),
    ("another word for a cylinder with ends", shaped('kind = "can"'), ["did you mean 'disc'?"]),
    ("no radius", shaped('kind = "sphere"'), ["body[1].shape", "'radius' is missing", "add radius"]),
    (
        "key of another shape",
        shaped('kind = "plane", radius = 1'),
        ["'radius' where kind is 'plane'", "'sphere'"],
    ),
    (
        "negative radius",
        shaped('kind = "sphere", radius = -0.1'),
        ["body[1].shape.radius", "-0.1", "a positive"],
    ),
    (
        "zero radius",
        shaped('kind = "sphere", radius = 0'),
        ["body[1].shape.radius", "the number 0", "a positive"],
    ),
    ("huge radius", shaped('kind = "sphere", radius = 1e31'), ["shape.radius", "1e+31", "up to 1e+30"]),
    ("huge integer", shaped(f'kind = "sphere", radius = 1{"0" * 400}'), ["a huge integer", "up to 1e+30"]),
    (
        "infinite radius",
        shaped('kind = "sphere", radius = inf'),
        ["shape.radius", "the number inf", "a positive"],
    ),
    (
        "two semi-axes",
        shaped('kind = "ellipsoid", semi_axes = [1, 2]'),
        ["semi_axes", "a list of 2", "a list of 3"],
    ),
    (
        "semi-axis of the wrong type",
        shaped('kind = "ellipsoid", semi_axes = [1, true, 1]'),
        ["body[1].shape.semi_axes[1]", "true", "a positive number"],
    ),
    (
        "exponent below two",
        shaped('kind = "superellipsoid", semi_axes = [1, 1, 1], exponents = [1, 2]'),
        ["exponents[0]", "the number 1", "from 2"],
    ),
    ("cavity not a switch", shaped('kind = "plane", cavity = "yes"'), ["cavity", "'yes'", "true or false"]),
    (
        "chart without domain",
        shaped('kind = "chart", x = "u", y = "v", z = "0"'),
        ["'domain' is missing", "[[u_min, u_max]"],
    ),
    (
        "chart parameter named u",
        chart("u", ", parameters = { u = 1 }"),
        ["shape.parameters", "'u'", "not pi, u, v"],
    ),
    ("position of length two", egg("position = [0, 0]"), ["body[1].position", "a list of 2", "a list of 3"]),
    (
        "position as text",
        egg('position = ["a", [], {}]').replace('"a"', "[]"),
        ["position[0]", "a list of 0"],
    ),
    (
        "two orientations",
        egg("rpy = [0, 0, 0]\nquaternion = [1, 0, 0, 0]"),
        ["body[1]", "'quaternion' and 'rpy' together", "one of", "remove"],
    ),
    ("mass and density", egg("density = 1.0"), ["'mass' and 'density' together", "remove the others"]),
    (
        "negative mass",
        egg("", mass=MASS.replace("1.0", "-1.0")),
        ["body[1].mass", "-1.0", "a positive number"],
    ),
    (
        "inertia of two",
        egg("", mass="mass = 1.0\ninertia = [1, 1]\n"),
        ["body[1].inertia", "a list of 2", "3 moments"],
    ),
    ("contact of three", SOUND.replace('["egg",', '["egg", "egg",'), ["contact[0].between", "a list of 3"]),
    ("restitution above one", SOUND + "restitution = 1.5", ["contact[0].restitution", "1.5", "from 0 to 1"]),
    ("negative friction", SOUND + "friction = -0.1", ["contact[0].friction", "-0.1", "from 0 to"]),
    ("friction as text", SOUND + "friction = true", ["contact[0].friction", "true", "a number"]),
    (
        "friction of three axes",
        SOUND + "friction = { kinetic = [0.1, 0.2, 0.3] }",
        ["contact[0].friction.kinetic", "a list of 3", "a list of 2"],
    ),
    (
        "unknown key of friction",
        SOUND + "friction = { dynamic = 0.3 }",
        ["contact[0].friction", "unknown key 'dynamic'", "static, kinetic, direction"],
    ),
    ("mu for friction", SOUND + "mu = 0.3", ["contact[0]", "unknown key 'mu'", "did you mean 'friction'?"]),
    (
        "negative resistance",
        SOUND + "friction = 0.3\nrolling_resistance = -1e-3",
        ["contact[0].rolling_resistance", "-0.001", "from 0 to"],
    ),
    ("unknown form", SOUND + 'form = "suport"', ["contact[0].form", "'suport'", "did you mean 'support'?"]),
    ("negative until", SOUND + "[run]\nuntil = -1", ["run.until", "the number -1", "a positive number"]),
    ("unknown accuracy", SOUND + '[run]\naccuracy = "tihgt"', ["run.accuracy", "did you mean 'tight'?"]),
    ("no samples", SOUND + "[run]\nsamples = 0", ["run.samples", "the number 0", "from 1"]),
    ("broken samples", SOUND + "[run]\nsamples = 1.5", ["run.samples", "the number 1.5", "a whole number"]),
    ("gravity as number", "gravity = 9.81\n" + SOUND, ["gravity: the number 9.81", "a list of 3"]),
    (
        "a date for a mass",
        egg("", mass="mass = 2020-01-01\n"),
        ["body[1].mass", "a date", "a positive number"],
    ),
    (
        "negative damping",
        SOUND + '[[spring]]\nbetween = ["egg", "table"]\nstiffness = 1\ndamping = -1',
        ["spring[0].damping", "the number -1", "from 0"],
    ),
]
