"""Runs every promise of voxshell against its oracle for as long as one likes, and counts: `./dev soak`."""
