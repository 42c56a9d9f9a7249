"""Queries of two bodies, in one pose or many, without Bullet."""

from voxshell.query.batch import ContactBatch, collide_batch, contacts_batch
from voxshell.query.bounds import ContactBounds, contact_bounds
from voxshell.query.contact_set import Contact, Contacts
from voxshell.query.distances import Distance, distance, distance_batch
from voxshell.query.queries import collide, contacts, deepest_per_segment, manifold
from voxshell.query.scratch import QueryScratch
from voxshell.query.sweeps import Sweep, SweepBatch, interpolate_pose, sweep, sweep_batch
from voxshell.query.wrenches import Wrench, wrench

__all__ = [
    "Contact",
    "ContactBatch",
    "ContactBounds",
    "Contacts",
    "Distance",
    "QueryScratch",
    "Sweep",
    "SweepBatch",
    "Wrench",
    "collide",
    "collide_batch",
    "contact_bounds",
    "contacts",
    "contacts_batch",
    "deepest_per_segment",
    "distance",
    "distance_batch",
    "interpolate_pose",
    "manifold",
    "sweep",
    "sweep_batch",
    "wrench",
]
