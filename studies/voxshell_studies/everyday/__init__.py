"""The study of everyday scenes: what it plans (``study``), and runs of a scene in each engine."""
