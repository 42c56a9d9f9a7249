"""Measurements: timing them, poses to time at, and writing results down with their environment."""
