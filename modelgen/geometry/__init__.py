"""Shapes: rigid motions, implicit surfaces, charts, curves, planar regions, features and the catalogue.

Takes in the shapes of a scene; gives out symbols for points, normals and curvature, and tables of faces,
edges and vertices. May import `model`, `scene` and what lies before them.
"""
