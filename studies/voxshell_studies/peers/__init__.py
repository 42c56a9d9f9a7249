"""Comparison with other libraries in equal poses: times, depths, drops.

Each peer has a module here with one function, ``set_up(job, variant)``, which returns a
:class:`~voxshell_studies.peers.protocol.Contender`. Each peer runs in a separate process.
"""
