"""Replays of recordings as offline web pages; an optional part, ``pip install voxshell[viewer]``.

``import voxshell`` imports nothing from here, and viser is imported only when a page is made.
"""
