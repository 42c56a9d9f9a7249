"""Replays of recordings as offline web pages; an optional part, ``pip install voxshell[viewer]``.

Nothing here is imported by ``import voxshell``, and viser only when a page is written.
"""
