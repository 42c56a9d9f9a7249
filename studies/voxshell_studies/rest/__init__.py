"""The study of rest: what it plans (``study``), and the bunny's fall in MuJoCo."""
