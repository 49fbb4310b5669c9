"""From recorded motion to numbers of a scene: a library and recordings in; values with confidence out."""
