"""What people would use instead of voxshell, on the same poses: times, depths, drops.

Each peer has a module here with one function, ``set_up(job, variant)``, which gives a
:class:`~voxshell_studies.peers.protocol.Contender`. Peers run in processes of their own.
"""
