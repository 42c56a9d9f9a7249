"""Scenes: what stands where, with typed settings, to simulate by name."""
