"""Scenes of sound structure that mean nothing: name, text, what the message says."""

from __future__ import annotations

from .broken_structure import CONTACT, EGG, MASS, SHAPE, SOUND, TABLE, Case, chart, egg, shaped

DISTANCE = '[[joint]]\nkind = "distance"\nbetween = ["table", "egg"]\n'
MEANING: list[Case] = [
    (
        "the pitch of a helix",
        shaped('kind = "helix", radius = 1, pitch = 0.1'),
        ["unknown key 'pitch'", "did you mean 'lead'", "2*pi"],
    ),
    (
        "a constant that nobody knows",
        "[constants]\nradius_0 = 0.1\n" + shaped('kind = "sphere", radius = "2*radius0"'),
        ["shape.radius", "unknown name 'radius0'", "did you mean 'radius_0'?"],
    ),
    (
        "constants in a ring",
        '[constants]\na = "b + 1"\nb = "2*c"\nc = "a"\n' + SOUND,
        ["constants.a", "depends on itself", "a -> b -> c -> a"],
    ),
    ("a constant of itself", '[constants]\na = "a"\n' + SOUND, ["constants.a", "a -> a"]),
    ("a constant of none", '[constants]\na = "b"\n' + SOUND, ["constants.a", "unknown name 'b'"]),
    ("the constant t", "[constants]\nt = 1\n" + SOUND, ["constants", "the name 't'", "but not t u v"]),
    ("the constant pi", "[constants]\npi = 3\n" + SOUND, ["constants", "the name 'pi'"]),
    ("a constant without value", '[constants]\na = 0\nb = "1/a"\n' + SOUND, ["constants.b", "finite"]),
    (
        "half a sample",
        '[constants]\nhalf = 0.5\n[run]\nsamples = "half"\n' + SOUND,
        ["run.samples", "'half'", "a whole number"],
    ),
    ("not TOML", "[[body]\nname = 1", ["not TOML", "line 1", "closing bracket"]),
    ("a key twice", egg("mass = 2.0"), ["not TOML", "line", "'mass' is given twice", "remove"]),
    ("a table twice", "[run]\nuntil = 1\n[run]\n", ["line 3", "[run] is written twice", "merge"]),
    ("table and list", "[body]\n[[body]]\n", ["line 2", "'body'", "write [[body]]"]),
    ("a decimal comma", "gravity = 0,5\n", ["line 1", "0,5", "decimal comma", "write 0.5"]),
    ("a point and a comma", "gravity = 1.000,5\n", ["1.000,5", "write 1000.5"]),
    ("no digit before", "gravity = -.5\n", ["-.5", "write -0.5"]),
    ("no digit after", "gravity = 5.\n", ["5.", "write 5.0"]),
    ("a unit", "gravity = 9.81 m/s^2\n", ["9.81", "'m/s^2'", "SI units"]),
    ("no quotation marks", "[[body]]\nname = egg\n", ["line 2", "egg", 'write "egg"']),
    ("an open text", '[[body]]\nname = "egg\n', ["line 2", "closing quotation mark"]),
    ("an open list", "gravity = [0, 0\n[run]\n", ["line 2", "closing bracket"]),
    ("no value", "[run]\nuntil =\n", ["line 2", "'until'", "without a value"]),
    ("a colon", "gravity: 1\n", ["':'", "write key = value"]),
    ("Python's true", "fold = True\n", ["True", "write true"]),
    ("a C comment", "// bodies\n", ["'// bodies'", "#"]),
    ("a foreign letter", "höhe = 1\n", ["'ö'", "keys"]),
    ("braces over two lines", "run = { until = 1,\n}\n", ["line 1", "braces", "one line"]),
    ("binary junk", "\x00\x01\x02", ["not TOML", "line 1"]),
    ("nested without end", "x = " + "[" * 5000, ["not TOML", "nested"]),
    ("five thousand digits", "x = 1" + "0" * 5000, ["not TOML", "digits"]),
    ("empty list of bodies", "body = []", ["body: no body", "add a [[body]]"]),
    (
        "NaN position",
        egg("position = [0, 0, nan]"),
        ["body[1].position[2]", "the number nan", "a number from"],
    ),
    ("expression of nothing", egg('position = [0, 0, "1/0"]'), ["position[2]", "column 1", "finite value"]),
    (
        "hostile number",
        egg("position = [0, 0, \"__import__('os')\"]"),
        ["position[2]", '"\'"', "allowed are"],
    ),
    ("unknown name in a number", egg('position = [0, 0, "h"]'), ["position[2]", "unknown name 'h'", "pi e"]),
    (
        "two bodies of one name",
        SOUND.replace("[[contact]]", EGG + "[[contact]]"),
        ["body[2]", "'egg'", "another name"],
    ),
    (
        "two shapes of one name",
        egg("", shape='shape = [{ kind = "plane" }, { kind = "plane" }]\n'),
        ["body[1].shape[1]", "a second shape named 'plane'", "another name"],
    ),
    (
        "zero quaternion",
        egg("quaternion = [0, 0, 0, 0]"),
        ["body[1].quaternion", "length zero", "[1, 0, 0, 0]"],
    ),
    (
        "axis and angle in a list",
        egg("axis_angle = [0, 0, 1, 0.5]"),
        ["axis_angle", "a list of 4", "a table is allowed", "write { axis = ..., angle = ... }"],
    ),
    (
        "zero axis",
        egg("axis_angle = { axis = [0, 0, 0], angle = 1 }"),
        ["axis_angle.axis", "length zero", "direction"],
    ),
    (
        "sheared rotation",
        egg("rotation = [[1, 0.1, 0], [0, 1, 0], [0, 0, 1]]"),
        ["body[1].rotation", "rows 0 and 0", "orthogonal rows", "quaternion"],
    ),
    (
        "reflection",
        egg("rotation = [[1, 0, 0], [0, 1, 0], [0, 0, -1]]"),
        ["body[1].rotation", "reflection", "+1"],
    ),
    (
        "no mass",
        egg("", mass=""),
        ["body[1] (body 'egg')", "without mass", "add mass and inertia, or density"],
    ),
    ("no inertia", egg("", mass="mass = 1.0\n"), ["body[1]", "without inertia", "add inertia"]),
    (
        "inertia beyond the triangle",
        egg("", mass="mass = 1.0\ninertia = [1, 1, 3]\n"),
        ["body[1].inertia", "1, 1, 3", "sum of the other two", "units"],
    ),
    (
        "singular inertia",
        egg("", mass="mass = 1.0\ninertia = [0, 1, 1]\n"),
        ["body[1].inertia", "principal moments 0, 1, 1", "positive"],
    ),
    (
        "indefinite inertia",
        egg("", mass="mass = 1.0\ninertia = [[1, 2, 0], [2, 1, 0], [0, 0, 1]]\n"),
        ["body[1].inertia", "-1, 1, 3", "positive"],
    ),
    (
        "skew inertia",
        egg("", mass="mass = 1.0\ninertia = [[1, 0.1, 0], [0, 1, 0], [0, 0, 1]]\n"),
        ["body[1].inertia", "not symmetric", "twice"],
    ),
    (
        "thick torus",
        shaped('kind = "torus", major = 0.1, minor = 0.2'),
        ["body[1].shape", "0.1", "larger than minor"],
    ),
    (
        "flat paraboloid",
        shaped('kind = "paraboloid", radii = [1, 0]'),
        ["body[1].shape", "radius 0", "not be zero"],
    ),
    (
        "density of a plane",
        egg("", mass="density = 1.0\n", shape='shape = { kind = "plane" }\n'),
        ["body[1].density", "the plane", "finite solid", "give mass and inertia"],
    ),
    (
        "density without shape",
        EGG.replace(SHAPE, "").replace(MASS, "density = 1.0\n"),
        ["body[0].density", "add a shape"],
    ),
    ("hostile chart", chart("().__class__"), ["body[1].shape.z", "attribute", "allowed are"]),
    ("unknown name in a chart", chart("w*u"), ["body[1].shape.z", "unknown name 'w'", "known names: u v"]),
    (
        "chart without finite value",
        chart("log(u)"),
        ["body[1].shape.z", "no finite value at u = -0.8", "domain"],
    ),
    (
        "chart of one variable",
        chart("u").replace('y = "v"', 'y = "u"'),
        ["body[1].shape", "do not depend on v", "use v"],
    ),
    (
        "reversed domain",
        chart("u").replace("[[-1, 1]", "[[1, -1]"),
        ["shape.domain[0]", "[1, -1]", "smaller"],
    ),
    (
        "open periodic chart",
        chart("u", ", periodic = [true, false]"),
        ["shape.x", "-1 and 1 at the two ends of u", "mend"],
    ),
    (
        "path of unknown names",
        egg('motion = "driven"\npath = { position = ["x", 0, 0] }', mass=""),
        ["body[1].path.position[0]", "unknown name 'x'", "known names: t"],
    ),
    (
        "path without start",
        egg('motion = "driven"\npath = { position = ["1/t", 0, 0] }', mass=""),
        ["body[1].path.position[0]", "no finite value at t = 0"],
    ),
    (
        "unknown body",
        SOUND.replace('"table"]', '"tabel"]'),
        ["contact[0].between", "'tabel'", "did you mean 'table'?"],
    ),
    (
        "unknown part",
        SOUND.replace('"table"]', '"table/plain"]'),
        ["contact[0].between", "'plain'", "'plane'?"],
    ),
    (
        "shape not chosen",
        egg("", shape='shape = [{ kind = "plane" }, { kind = "sphere", radius = 1 }]\n'),
        ["contact[0].between", "2 shapes", "'egg/plane' or 'egg/sphere'"],
    ),
    (
        "contact without shape",
        SOUND.replace(SHAPE, ""),
        ["contact[0].between", "'egg' without a shape", "add a shape"],
    ),
    (
        "contact with itself",
        SOUND.replace('"table"]', '"egg"]'),
        ["contact[0].between", "with itself", "different"],
    ),
    (
        "contact of fixed bodies",
        TABLE + TABLE.replace("table", "egg") + CONTACT,
        ["contact[0].between", "'egg' (fixed) and 'table' (fixed)", "must be dynamic"],
    ),
    (
        "friction of nothing",
        SOUND + "friction = {}",
        ["contact[0].friction", "no coefficient", "friction = 0.3"],
    ),
    (
        "kinetic above static",
        SOUND + "friction = { static = 0.2, kinetic = 0.3 }",
        ["contact[0].friction", "static 0.2 below kinetic 0.3", "exchange"],
    ),
    (
        "friction along the normal of a plane",
        SOUND.replace('["egg", "table"]', '["table", "egg"]')
        + "friction = { kinetic = [0.2, 0.1], direction = [0, 0, 2] }",
        ["contact[0].friction.direction", "along the normal of the plane of 'table'", "turn it"],
    ),
    (
        "two coefficients without a direction",
        SOUND + "friction = { kinetic = [0.2, 0.3] }",
        ["contact[0].friction", "without a direction", "add direction"],
    ),
    (
        "a direction of one coefficient",
        SOUND + "friction = { kinetic = 0.2, direction = [1, 0, 0] }",
        ["contact[0].friction.direction", "one coefficient", "remove"],
    ),
    (
        "slippery along one axis",
        SOUND + "friction = { kinetic = [0.2, 0.0], direction = [1, 0, 0] }",
        ["contact[0].friction.kinetic", "[0.2, 0.0]", "both"],
    ),
    (
        "resistance without friction",
        SOUND + "rolling_resistance = 1e-3",
        ["contact[0].rolling_resistance", "without friction", "add friction"],
    ),
    (
        "contact twice",
        SOUND + CONTACT.replace('"egg", "table"', '"table", "egg"'),
        ["contact[1].between", "a second time", "remove one"],
    ),
    (
        "distance and its motion",
        SOUND + DISTANCE + 'distance = 0.5\nmotion = "0.5 + t"\n',
        ["joint[0]", "a distance and a motion", "one of the two"],
    ),
    (
        "neither distance nor motion",
        SOUND + DISTANCE,
        ["neither a distance nor a motion", "write"],
    ),
    (
        "a cone beyond a half space and back",
        SOUND + DISTANCE.replace("distance", "spherical") + 'limits = ["none", 4.0]\n',
        ["joint[0]", "limits", "a tilt that is no angle of a cone", "between 0 and pi"],
    ),
    (
        "rebounds from limits that are not there",
        SOUND + DISTANCE.replace("distance", "revolute") + "restitution = 0.5\n",
        ["joint[0]", "restitution", "0.5 without limits", "add limits"],
    ),
    (
        "rest of no spring",
        SOUND + DISTANCE.replace("distance", "revolute") + "rest = 0.5\n",
        ["joint[0]", "rest", "0.5 without stiffness", "add stiffness"],
    ),
    (
        "a step longer than the run",
        '[run]\nuntil = 0.1\nmethod = "rk4"\nstep = 0.2\n' + SOUND,
        ["run.step", "0.2 s", "the run of 0.1 s", "shorten"],
    ),
    (
        "a step of no method",
        "[run]\nstep = 0.1\n" + SOUND,
        ["run.step", "0.1", 'method = "rk4" or "time-stepping" with it', "give both, or neither"],
    ),
    (
        "a scheme of another method",
        '[run]\nmethod = "rk4"\nstep = 0.1\nscheme = "moreau"\n' + SOUND,
        ["run.scheme", "'moreau'", 'method = "time-stepping" with it'],
    ),
    (
        "a box the wrong way round",
        SOUND + DISTANCE.replace("distance", "planar") + "limits_y = [1.0, -1.0]\n",
        ["joint[0]", "limits_y", "1 to -1", "write the least first"],
    ),
    ("observed nobody", 'observe = ["eg.position"]\n' + SOUND, ["observe[0]", "'eg'", "did you mean 'egg'?"]),
    ("observed nothing", 'observe = ["egg.velocty"]\n' + SOUND, ["observe[0]", "'velocty'", "'velocity'?"]),
    (
        "force on a fixed body",
        SOUND + '[[force]]\nbody = "table"\nforce = [0, 0, 1]',
        ["force[0].body", "'table', which is fixed", "dynamic"],
    ),
    (
        "force of unknown names",
        SOUND + '[[force]]\nbody = "egg"\nforce = [0, 0, "-vzz"]',
        ["force[0].force[2]", "'vzz'", "did you mean 'vz'?"],
    ),
    (
        "hostile torque",
        SOUND + '[[torque]]\nbody = "egg"\ntorque = [0, 0, "exec(t)"]',
        ["torque[0].torque[2]", "unknown function 'exec'", "functions: sin"],
    ),
    (
        "spring with itself",
        SOUND + '[[spring]]\nbetween = ["egg", "egg"]\nstiffness = 1',
        ["spring[0].between", "with itself", "different"],
    ),
]
