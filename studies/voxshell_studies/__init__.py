"""Experiments: scenes run, measured, and written down as data, figures and pages."""
