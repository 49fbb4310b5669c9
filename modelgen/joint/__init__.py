"""Joints: equations that two bodies keep, and what acts along the coordinate that they leave free."""
