"""Experiments: scenes that are simulated, measured, and reported as data, figures and pages."""
