"""Code that every folder uses: arguments, poses, rotations, settings, and file input and output."""
