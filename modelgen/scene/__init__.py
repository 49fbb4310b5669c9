"""Scenes: files (TOML), the values that they become, and scenes written in Python.

A scene file lists bodies, the pairs of shapes that may touch, loads and settings, in SI units:

    gravity = [0, 0, -9.81]

    [[body]]
    name = "table"
    motion = "fixed"                      # fixed, driven (by path = { ... } in expressions of t) or dynamic
    shape = { kind = "plane" }

    [[body]]
    name = "egg"
    shape = { kind = "ellipsoid", semi_axes = [0.03, 0.02, 0.02] }
    density = 1000                        # or mass and inertia
    position = [0, 0, 0.02]
    axis_angle = { axis = [0, 1, 0], angle = "pi/2" }    # or quaternion, rpy, rotation

    [[contact]]
    between = ["egg", "table"]            # "body" or "body/shape"
    restitution = 0.5

    [run]
    until = 2

Where a number stands, a text such as "pi/2" may stand as well. Further tables: [[force]], [[torque]] (three
expressions of t and the body's state) and [[spring]]. `format` holds every key, type, range and default.
"""
