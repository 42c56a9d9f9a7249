"""Scene files: bodies and joints with typed settings, to simulate."""
