"""Scenes for use elsewhere: takes a scene, writes a folder of C, FMUs, CasADi functions, MJCF or URDF."""
