"""Composite shapes: faces, edges and vertices with the conditions under which a contact leaves each of them.

Takes in a solid, spline or chart of a scene; gives out a `Composite`. One family of shapes a module.
"""
