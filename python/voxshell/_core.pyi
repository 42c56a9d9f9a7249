"""
The compiled core. Use it through the package voxshell, which checks arguments.
"""

from collections.abc import Callable, Sequence
import enum
from typing import Annotated, Final

import numpy
import numpy.typing
from numpy.typing import NDArray


version: str = '0.1.0'

class Field:
    """A signed distance field of any kind."""

    def sample(self, points: Annotated[NDArray[numpy.float64], dict(shape=(None, 3), order='C', device='cpu', writable=False)]) -> Annotated[NDArray[numpy.float64], dict(shape=(None,))]:
        """Return signed distances, meters, (n,)."""

    def gradient(self, points: Annotated[NDArray[numpy.float64], dict(shape=(None, 3), order='C', device='cpu', writable=False)]) -> Annotated[NDArray[numpy.float64], dict(shape=(None, 3))]:
        """Return gradients of the distance, (n, 3)."""

class GridField:
    """Properties that only a sampled field has."""

    @property
    def shape(self) -> list[int]: ...

    @property
    def voxel_size(self) -> float: ...

    @property
    def origin(self) -> list[float]: ...

    @property
    def nbytes(self) -> int: ...

    @property
    def interpolation_error(self) -> float: ...

    @property
    def surface_error(self) -> float: ...

    @property
    def sign_method(self) -> str: ...

    @property
    def sign_confidence(self) -> float: ...

    @property
    def was_turned(self) -> bool: ...

    @property
    def faults(self) -> list[int]:
        """
        Open, non-manifold and wrongly oriented edges, nodes in overlaps, hidden triangles.
        """

    @property
    def first_fault(self) -> list[float]: ...

def plane_field(normal: Sequence[float], offset: float) -> Field: ...

def box_field(half_extents: Sequence[float]) -> Field: ...

def sphere_field(radius: float) -> Field: ...

def capsule_field(radius: float, length: float) -> Field: ...

def cylinder_field(radius: float, length: float) -> Field: ...

def cone_field(radius: float, height: float) -> Field: ...

def convex_field(vertices: Annotated[NDArray[numpy.float64], dict(shape=(None, 3), order='C', device='cpu', writable=False)], faces: Annotated[NDArray[numpy.uint32], dict(shape=(None, 3), order='C', device='cpu', writable=False)]) -> tuple[Field, int]:
    """Return the field and its number of faces."""

class PointShell:
    """Points on a surface, in the order of their tree."""

    def __len__(self) -> int: ...

    @property
    def points(self) -> Annotated[NDArray[numpy.float32], dict(shape=(None, 3), writable=False)]: ...

    @property
    def normals(self) -> Annotated[NDArray[numpy.float32], dict(shape=(None, 3), writable=False)]: ...

    @property
    def areas(self) -> Annotated[NDArray[numpy.float32], dict(shape=(None,), writable=False)]: ...

    @property
    def edges(self) -> Annotated[NDArray[numpy.float32], dict(shape=(None, 2, 3), writable=False)]: ...

    @property
    def spacing(self) -> float: ...

    @property
    def tree(self) -> PointSphereTree: ...

class PointSphereTree:
    """Nested clusters of a shell's points."""

    branching: Final[int] = ...
    """(arg: object, /) -> int"""

    deepest_level: Final[int] = ...
    """(arg: object, /) -> int"""

    @property
    def levels(self) -> int: ...

    def spheres(self, level: int) -> Annotated[NDArray[numpy.float32], dict(shape=(None, 4), writable=False)]:
        """Return centers and radii, (m, 4); level 1 to levels."""

    def segments(self, level: int) -> Annotated[NDArray[numpy.int64], dict(shape=(None,))]:
        """Return the cluster of each point, (n,); level 1 to deepest_level."""

class Model:
    """Field, shell and mass properties of a mesh."""

    @staticmethod
    def build(vertices: numpy.typing.NDArray[numpy.float64], faces: numpy.typing.NDArray[numpy.uint32], *, tolerance: float, voxel_size: float, resolution: int, point_spacing: float, target_points: int, padding: float, sign: str, open: str, sheet_thickness: float, threads: int, progress: Callable[[str, float], object] | None) -> Model:
        """Build a model. With 0 (padding: below 0) the core chooses a setting."""

    def save(self, path: bytes) -> None: ...

    @staticmethod
    def load(path: bytes) -> Model: ...

    def to_bytes(self) -> bytes:
        """Return the bytes that `save` writes."""

    @staticmethod
    def from_bytes(content: bytes) -> Model: ...

    @property
    def vertices(self) -> Annotated[NDArray[numpy.float64], dict(shape=(None, 3), writable=False)]: ...

    @property
    def faces(self) -> Annotated[NDArray[numpy.uint32], dict(shape=(None, 3), writable=False)]: ...

    @property
    def bounds(self) -> list[list[float]]: ...

    @property
    def field(self) -> Field: ...

    @property
    def grid(self) -> GridField: ...

    @property
    def shell(self) -> PointShell: ...

    @property
    def accuracy(self) -> tuple[int, list[float], list[float], list[float], float, bool, float]:
        """
        Number of places; median, 99 % and worst of distance, normal and coverage; gap; is_sharp; curvature.
        """

    @property
    def openings(self) -> tuple[int, float, int, float, list[float], float]:
        """
        Loops, fraction, mouths, largest diameter, first location, and the sheet's thickness or 0.
        """

    @property
    def tolerance(self) -> float:
        """Meters; 0 if the model is uniform."""

    @property
    def thickness(self) -> float:
        """Thickness of the thinnest walls, meters."""

    @property
    def solid_mass_properties(self) -> tuple[list[float], list[list[float]]]:
        """Center of mass and inertia tensor about it, at 1 kg."""

    @property
    def surface_mass_properties(self) -> tuple[list[float], list[list[float]]]:
        """Center of mass and inertia tensor about it, at 1 kg."""

class Shells(enum.Enum):
    AUTOMATIC = 0

    FEWEST = 1

    A = 2

    B = 3

    BOTH = 4

class Role(enum.Enum):
    A = 0

    B = 1

    BOTH = 2

class ContactSet:
    """Contacts of a pair, world frame."""

    @property
    def points_a(self) -> Annotated[NDArray[numpy.float64], dict(shape=(None, 3), writable=False)]: ...

    @property
    def points_b(self) -> Annotated[NDArray[numpy.float64], dict(shape=(None, 3), writable=False)]: ...

    @property
    def normals(self) -> Annotated[NDArray[numpy.float64], dict(shape=(None, 3), writable=False)]: ...

    @property
    def depths(self) -> Annotated[NDArray[numpy.float64], dict(shape=(None,), writable=False)]: ...

    @property
    def ids(self) -> Annotated[NDArray[numpy.int64], dict(shape=(None,), writable=False)]: ...

    @property
    def segments(self) -> Annotated[NDArray[numpy.int64], dict(shape=(None,), writable=False)]: ...

    @property
    def shells(self) -> Annotated[NDArray[numpy.uint8], dict(shape=(None,), writable=False)]:
        """0: a's shell, 1: b's shell."""

    @property
    def inner(self) -> Annotated[NDArray[numpy.uint8], dict(shape=(None,), writable=False)]: ...

    def __len__(self) -> int: ...

    @property
    def role(self) -> Role: ...

    def find_ambiguous(self) -> Annotated[NDArray[numpy.bool_], dict(shape=(None,))]:
        """Return for each contact whether its depth and normal are ambiguous."""

    @property
    def exact(self) -> bool: ...

    @property
    def depth_bound(self) -> float: ...

    def manifold(self, max_points: int) -> ContactSet:
        """Return at most 4 contacts, in the order of choice."""

    def deepest_per_segment(self) -> ContactSet:
        """
        Return those of a's shell, then of b's, each in ascending order of ids.
        """

class QueryScratch:
    """Memory of queries. Threads that share one take turns."""

    def __init__(self) -> None: ...

def contacts(field_a: Field, model_a: Model | None, field_b: Field, model_b: Model | None, a_pose: Annotated[NDArray[numpy.float64], dict(shape=(4, 4))] | None, b_pose: Annotated[NDArray[numpy.float64], dict(shape=(4, 4))] | None, shells: Shells, margin: float, level: int, max_points: int | None, budget: int | None, scratch: QueryScratch | None) -> ContactSet:
    """Find contacts with the point-sphere tree."""

def contacts_flat(field_a: Field, model_a: Model | None, field_b: Field, model_b: Model | None, a_pose: Annotated[NDArray[numpy.float64], dict(shape=(4, 4))] | None, b_pose: Annotated[NDArray[numpy.float64], dict(shape=(4, 4))] | None, shells: Shells, margin: float, level: int, max_points: int | None, budget: int | None, scratch: QueryScratch | None) -> ContactSet:
    """Find contacts with the flat loop."""

def manifold(field_a: Field, model_a: Model | None, field_b: Field, model_b: Model | None, a_pose: Annotated[NDArray[numpy.float64], dict(shape=(4, 4))] | None, b_pose: Annotated[NDArray[numpy.float64], dict(shape=(4, 4))] | None, shells: Shells, margin: float, max_points: int, scratch: QueryScratch | None) -> ContactSet:
    """
    Find a manifold by branch and bound; for both shells, from all contacts.
    """

def deepest_per_segment(field_a: Field, model_a: Model | None, field_b: Field, model_b: Model | None, a_pose: Annotated[NDArray[numpy.float64], dict(shape=(4, 4))] | None, b_pose: Annotated[NDArray[numpy.float64], dict(shape=(4, 4))] | None, shells: Shells, margin: float, level: int, scratch: QueryScratch | None) -> ContactSet:
    """Find the deepest contacts by branch and bound, for each shell."""

def role(field_a: Field, model_a: Model | None, field_b: Field, model_b: Model | None, shells: Shells) -> tuple[Role, float, float, float, float, float, float, float]:
    """
    Return the role, and in meters what it, a, b and both may miss, the smaller body's thickness and shortest side, and the thinner body's thickness.
    """

def pair_bounds(field_a: Field, model_a: Model | None, field_b: Field, model_b: Model | None, role: Role) -> tuple[float, float]:
    """Return overlap and clearance, meters."""

def collide(field_a: Field, model_a: Model | None, field_b: Field, model_b: Model | None, a_pose: Annotated[NDArray[numpy.float64], dict(shape=(4, 4))] | None, b_pose: Annotated[NDArray[numpy.float64], dict(shape=(4, 4))] | None, shells: Shells, margin: float) -> bool: ...

def distance(field_a: Field, model_a: Model | None, field_b: Field, model_b: Model | None, a_pose: Annotated[NDArray[numpy.float64], dict(shape=(4, 4))] | None, b_pose: Annotated[NDArray[numpy.float64], dict(shape=(4, 4))] | None, shells: Shells, max_distance: float, scratch: QueryScratch | None) -> tuple[float, list[float], list[float], list[float], bool] | None:
    """
    Return distance, point on a, point on b, normal, and whether a's shell is nearest; or None.
    """

def distance_batch(field_a: Field, model_a: Model | None, field_b: Field, model_b: Model | None, count: int, a_poses: Annotated[NDArray[numpy.float64], dict(shape=(None, 4, 4), order='C', device='cpu', writable=False)] | None, b_poses: Annotated[NDArray[numpy.float64], dict(shape=(None, 4, 4), order='C', device='cpu', writable=False)] | None, shells: Shells, max_distance: float, threads: int, progress: object | None) -> Annotated[NDArray[numpy.float64], dict(shape=(None,))]:
    """Return (k,) float64; infinite where nothing is near enough."""

def sweep(field_a: Field, model_a: Model | None, field_b: Field, model_b: Model | None, a_pose: Annotated[NDArray[numpy.float64], dict(shape=(4, 4))] | None, a_end: Annotated[NDArray[numpy.float64], dict(shape=(4, 4))] | None, b_pose: Annotated[NDArray[numpy.float64], dict(shape=(4, 4))] | None, b_end: Annotated[NDArray[numpy.float64], dict(shape=(4, 4))] | None, shells: Shells, margin: float, tolerance: float | None, scratch: QueryScratch | None) -> tuple[NDArray[numpy.float64], NDArray[numpy.float64], NDArray[numpy.float64], NDArray[numpy.float64], NDArray[numpy.float64], NDArray[numpy.int64], NDArray[numpy.float64], NDArray[numpy.float64]]:
    """
    Call sweep_batch() for one motion. Without an end, a body does not move.
    """

def sweep_batch(field_a: Field, model_a: Model | None, field_b: Field, model_b: Model | None, count: int, a_poses: Annotated[NDArray[numpy.float64], dict(shape=(None, 4, 4), order='C', device='cpu', writable=False)] | None, a_ends: Annotated[NDArray[numpy.float64], dict(shape=(None, 4, 4), order='C', device='cpu', writable=False)] | None, b_poses: Annotated[NDArray[numpy.float64], dict(shape=(None, 4, 4), order='C', device='cpu', writable=False)] | None, b_ends: Annotated[NDArray[numpy.float64], dict(shape=(None, 4, 4), order='C', device='cpu', writable=False)] | None, shells: Shells, margin: float, tolerance: float | None, threads: int, progress: object | None) -> tuple[NDArray[numpy.float64], NDArray[numpy.float64], NDArray[numpy.float64], NDArray[numpy.float64], NDArray[numpy.float64], NDArray[numpy.int64], NDArray[numpy.float64], NDArray[numpy.float64]]:
    """
    Return fractions, distances, points on a and b, normals, shells (0: a's, 1: b's, -1: none), and poses of a and b.
    """

def interpolate(start: Annotated[NDArray[numpy.float64], dict(shape=(4, 4))] | None, end: Annotated[NDArray[numpy.float64], dict(shape=(4, 4))] | None, at: Annotated[NDArray[numpy.float64], dict(shape=(None,), order='C', device='cpu', writable=False)]) -> NDArray[numpy.float64]:
    """Return (k, 4, 4) poses."""

def wrench(field_a: Field, model_a: Model | None, field_b: Field, model_b: Model | None, a_pose: Annotated[NDArray[numpy.float64], dict(shape=(4, 4))] | None, b_pose: Annotated[NDArray[numpy.float64], dict(shape=(4, 4))] | None, shells: Shells, stiffness: float, scratch: QueryScratch | None) -> tuple[list[float], list[float]]:
    """
    Return force and torque on a about its origin, world frame; for both shells the mean.
    """

class ContactBatch:
    """Contacts of many poses of a pair."""

    @property
    def points_a(self) -> Annotated[NDArray[numpy.float64], dict(shape=(None, 3), writable=False)]: ...

    @property
    def points_b(self) -> Annotated[NDArray[numpy.float64], dict(shape=(None, 3), writable=False)]: ...

    @property
    def normals(self) -> Annotated[NDArray[numpy.float64], dict(shape=(None, 3), writable=False)]: ...

    @property
    def depths(self) -> Annotated[NDArray[numpy.float64], dict(shape=(None,), writable=False)]: ...

    @property
    def ids(self) -> Annotated[NDArray[numpy.int64], dict(shape=(None,), writable=False)]: ...

    @property
    def segments(self) -> Annotated[NDArray[numpy.int64], dict(shape=(None,), writable=False)]: ...

    @property
    def shells(self) -> Annotated[NDArray[numpy.uint8], dict(shape=(None,), writable=False)]:
        """0: a's shell, 1: b's shell."""

    @property
    def inner(self) -> Annotated[NDArray[numpy.uint8], dict(shape=(None,), writable=False)]: ...

    def __len__(self) -> int: ...

    @property
    def offsets(self) -> Annotated[NDArray[numpy.int64], dict(shape=(None,), writable=False)]: ...

    def at(self, arg: int, /) -> ContactSet: ...

def contacts_batch(field_a: Field, model_a: Model | None, field_b: Field, model_b: Model | None, count: int, a_poses: Annotated[NDArray[numpy.float64], dict(shape=(None, 4, 4), order='C', device='cpu', writable=False)] | None, b_poses: Annotated[NDArray[numpy.float64], dict(shape=(None, 4, 4), order='C', device='cpu', writable=False)] | None, shells: Shells, margin: float, level: int, max_points: int | None, threads: int, progress: object | None) -> ContactBatch:
    """
    Poses are (count, 4, 4); a single pose that applies to all is (1, 4, 4).
    """

def collide_batch(field_a: Field, model_a: Model | None, field_b: Field, model_b: Model | None, count: int, a_poses: Annotated[NDArray[numpy.float64], dict(shape=(None, 4, 4), order='C', device='cpu', writable=False)] | None, b_poses: Annotated[NDArray[numpy.float64], dict(shape=(None, 4, 4), order='C', device='cpu', writable=False)] | None, shells: Shells, margin: float, threads: int, progress: object | None) -> Annotated[NDArray[numpy.bool_], dict(shape=(None,))]:
    """Return (k,) bool."""
