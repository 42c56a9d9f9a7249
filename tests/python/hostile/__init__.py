"""Hostile input files: a kept corpus, the process that opens them within limits, and mutations of them."""
