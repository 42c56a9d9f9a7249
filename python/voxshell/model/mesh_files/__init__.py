"""Mesh files: opening them, and checking what they require before a library reads them."""
