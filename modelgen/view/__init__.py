"""Pages that play a run: from a scene and its run to one HTML file that needs no network.

`meshes` makes triangles and lines of the bodies, `frames` takes from a record what moves, `page` writes both
into the page with its WebGL program (player.html).
"""
