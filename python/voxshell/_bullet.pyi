"""Stock Bullet with voxshell's models. Use it through voxshell.World."""

from collections.abc import Sequence
import enum
from typing import Annotated

import numpy
from numpy.typing import NDArray
import voxshell._core


class ModelGeometry:
    def __init__(self, model: voxshell._core.Model) -> None: ...

class PlaneGeometry:
    def __init__(self, arg0: Sequence[float], arg1: float, /) -> None: ...

class BoxGeometry:
    def __init__(self, arg: Sequence[float], /) -> None: ...

class SphereGeometry:
    def __init__(self, arg: float, /) -> None: ...

class GImpactGeometry:
    def __init__(self, arg0: Annotated[NDArray[numpy.float64], dict(shape=(None, 3), order='C', device='cpu', writable=False)], arg1: Annotated[NDArray[numpy.uint32], dict(shape=(None, 3), order='C', device='cpu', writable=False)], arg2: float, /) -> None: ...

class HullsGeometry:
    def __init__(self, arg0: Sequence[Annotated[NDArray[numpy.float64], dict(shape=(None, 3), order='C', device='cpu', writable=False)]], arg1: float, /) -> None: ...

def triangulate_hulls(hulls: Sequence[Annotated[NDArray[numpy.float64], dict(shape=(None, 3), order='C', device='cpu', writable=False)]]) -> tuple[NDArray[numpy.float64], NDArray[numpy.uint32]]:
    """Vertices (n, 3) and triangles (m, 3) of the hulls of sets of points."""

def mesh_mass_properties(vertices: Annotated[NDArray[numpy.float64], dict(shape=(None, 3), order='C', device='cpu', writable=False)], faces: Annotated[NDArray[numpy.uint32], dict(shape=(None, 3), order='C', device='cpu', writable=False)], kind: str) -> tuple[list[float], list[list[float]]]:
    """
    Centre of mass and inertia tensor about it at 1 kg, of kind 'solid' or 'surface'.
    """

def sample_hull(points: Annotated[NDArray[numpy.float64], dict(shape=(None, 3), order='C', device='cpu', writable=False)]) -> NDArray[numpy.float64]:
    """Vertices of the hull in the 42 directions of btShapeHull, (n, 3)."""

class ContactMode(enum.Enum):
    AUTO = 0

    REGULAR = 1

    SEGMENTED = 2

class ConstraintSolver(enum.Enum):
    SEQUENTIAL_IMPULSE = 0

    NNCG = 1

    DANTZIG = 2

    PROJECTED_GAUSS_SEIDEL = 3

class Simulation:
    def __init__(self, gravity: Sequence[float], time_step: float, sleeping: bool, split_impulse_threshold: float, solver: ConstraintSolver, iterations: int, mode: ContactMode, level: int, margin: float, sweep_beyond: float) -> None: ...

    def add_body(self, geometry: ModelGeometry | PlaneGeometry | BoxGeometry | SphereGeometry | GImpactGeometry | HullsGeometry, mass: float, centre_of_mass: Sequence[float], inertia: Sequence[Sequence[float]], pose: Annotated[NDArray[numpy.float64], dict(shape=(4, 4), order='C', device='cpu', writable=False)], friction: float, restitution: float) -> int: ...

    def step(self, count: int) -> None: ...

    def timings(self) -> NDArray[numpy.float64]: ...

    def clear_timings(self) -> None: ...

    def contacts(self) -> NDArray[numpy.float64]: ...

    def pose(self, arg: int, /) -> NDArray[numpy.float64]: ...

    def set_pose(self, arg0: int, arg1: Annotated[NDArray[numpy.float64], dict(shape=(4, 4), order='C', device='cpu', writable=False)], /) -> None: ...

    def linear_velocity(self, arg: int, /) -> list[float]: ...

    def angular_velocity(self, arg: int, /) -> list[float]: ...

    def set_linear_velocity(self, arg0: int, arg1: Sequence[float], /) -> None: ...

    def set_angular_velocity(self, arg0: int, arg1: Sequence[float], /) -> None: ...

    def is_asleep(self, arg: int, /) -> bool: ...

most_timings: int = 100000

bullet_version: int = 324
