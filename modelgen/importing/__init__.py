"""Files of other programs as scenes: MJCF, URDF, and profiles that were measured.

Takes in a file, gives out the text of a scene, with what of the file is left out or taken otherwise. May
import `scene` and what lies before it.
"""
