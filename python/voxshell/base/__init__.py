"""What all rooms share: arguments, poses and their rotations, settings, files read and written."""
