"""Measurements: timing, poses, and results with their environment."""
