"""Stock Bullet with voxshell's models. Use it through voxshell.World."""

from collections.abc import Mapping, Sequence
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

class CapsuleGeometry:
    def __init__(self, arg0: float, arg1: float, /) -> None: ...

class CylinderGeometry:
    def __init__(self, arg0: float, arg1: float, /) -> None: ...

class ConeGeometry:
    def __init__(self, arg0: float, arg1: float, /) -> None: ...

class GImpactGeometry:
    def __init__(self, arg0: Annotated[NDArray[numpy.float64], dict(shape=(None, 3), order='C', device='cpu', writable=False)], arg1: Annotated[NDArray[numpy.uint32], dict(shape=(None, 3), order='C', device='cpu', writable=False)], arg2: float, /) -> None: ...

class HullsGeometry:
    def __init__(self, arg0: Sequence[Annotated[NDArray[numpy.float64], dict(shape=(None, 3), order='C', device='cpu', writable=False)]], arg1: float, /) -> None: ...

class CompoundGeometry:
    def __init__(self, arg: Sequence[tuple[ModelGeometry | PlaneGeometry | BoxGeometry | SphereGeometry | CapsuleGeometry | CylinderGeometry | ConeGeometry | GImpactGeometry | HullsGeometry, Annotated[NDArray[numpy.float64], dict(shape=(4, 4))]]], /) -> None: ...

def triangulate_hulls(hulls: Sequence[Annotated[NDArray[numpy.float64], dict(shape=(None, 3), order='C', device='cpu', writable=False)]]) -> tuple[NDArray[numpy.float64], NDArray[numpy.uint32]]:
    """
    Return vertices (n, 3) and triangles (m, 3) of the hulls of sets of points.
    """

def mesh_mass_properties(vertices: Annotated[NDArray[numpy.float64], dict(shape=(None, 3), order='C', device='cpu', writable=False)], faces: Annotated[NDArray[numpy.uint32], dict(shape=(None, 3), order='C', device='cpu', writable=False)], kind: str) -> tuple[list[float], list[list[float]]]:
    """
    Return center of mass and inertia tensor about it at 1 kg; kind is 'solid' or 'surface'.
    """

def sample_hull(points: Annotated[NDArray[numpy.float64], dict(shape=(None, 3), order='C', device='cpu', writable=False)]) -> NDArray[numpy.float64]:
    """
    Return vertices of the hull in the 42 directions of btShapeHull, (n, 3).
    """

class JointKind(enum.Enum):
    FIXED = 0

    HINGE = 1

    SLIDER = 2

    POINT = 3

class JointSettings:
    def __init__(self, *, kind: JointKind, parent: int, child: int, parent_from_joint: Annotated[NDArray[numpy.float64], dict(shape=(4, 4))], child_from_joint: Annotated[NDArray[numpy.float64], dict(shape=(4, 4))], lower: float, upper: float, friction: float, damping: float, stiffness: float, spring_position: float, armature: float, collides: bool) -> None: ...

class MotorMode(enum.Enum):
    NONE = 0

    VELOCITY = 1

    POSITION = 2

    FOLLOW = 3

class Motor:
    def __init__(self, mode: MotorMode, target: float, max_force: float, max_speed: float, leader: int = -1, multiplier: float = 1.0, velocity: float = 0.0) -> None: ...

    @property
    def mode(self) -> MotorMode: ...

    @property
    def target(self) -> float: ...

    @property
    def max_force(self) -> float: ...

    @property
    def max_speed(self) -> float: ...

    @property
    def leader(self) -> int: ...

    @property
    def multiplier(self) -> float: ...

    @property
    def velocity(self) -> float: ...

class JointReading:
    @property
    def position(self) -> float: ...

    @property
    def velocity(self) -> float: ...

class ContactMode(enum.Enum):
    AUTO = 0

    REGULAR = 1

    SEGMENTED = 2

class ShellRule(enum.Enum):
    AUTO = 0

    FEWEST = 1

class ConstraintSolver(enum.Enum):
    COULOMB = 0

    SEQUENTIAL_IMPULSE = 1

    NNCG = 2

    DANTZIG = 3

    PROJECTED_GAUSS_SEIDEL = 4

class SolverEffort(enum.Enum):
    FIXED = 0

    AS_NEEDED = 1

class Motion(enum.Enum):
    DYNAMIC = 0

    STATIC = 1

    KINEMATIC = 2

class BodyMaterial:
    def __init__(self) -> None: ...

    @property
    def friction(self) -> float: ...

    @friction.setter
    def friction(self, arg: float, /) -> None: ...

    @property
    def rolling_friction(self) -> float: ...

    @rolling_friction.setter
    def rolling_friction(self, arg: float, /) -> None: ...

    @property
    def spinning_friction(self) -> float: ...

    @spinning_friction.setter
    def spinning_friction(self, arg: float, /) -> None: ...

    @property
    def restitution(self) -> float: ...

    @restitution.setter
    def restitution(self, arg: float, /) -> None: ...

    @property
    def linear_damping(self) -> float: ...

    @linear_damping.setter
    def linear_damping(self, arg: float, /) -> None: ...

    @property
    def angular_damping(self) -> float: ...

    @angular_damping.setter
    def angular_damping(self, arg: float, /) -> None: ...

    @property
    def surface_velocity(self) -> list[float]: ...

    @surface_velocity.setter
    def surface_velocity(self, arg: Sequence[float], /) -> None: ...

    @property
    def group(self) -> int: ...

    @group.setter
    def group(self, arg: int, /) -> None: ...

    @property
    def mask(self) -> int: ...

    @mask.setter
    def mask(self, arg: int, /) -> None: ...

class SimulationState:
    def to_rows(self) -> dict[str, NDArray[numpy.float64]]: ...

    @staticmethod
    def from_rows(arg: Mapping[str, Annotated[NDArray[numpy.float64], dict(shape=(None, None), order='C', device='cpu', writable=False)]], /) -> SimulationState: ...

most_turn: float = 0.7853981633974483

most_way: float = 100000.0

most_extent: float = 500000.0

most_mass: float = 1000000000000000.0

class Simulation:
    def __init__(self, gravity: Sequence[float], time_step: float, sleeping: bool, split_impulse_threshold: float, solver: ConstraintSolver, iterations: int, effort: SolverEffort, two_friction_directions: bool, mode: ContactMode, shell: ShellRule, level: int, margin: float, ccd_motion_threshold: float, threads: int) -> None: ...

    def step(self, count: int) -> None: ...

    def add_body(self, geometry: ModelGeometry | PlaneGeometry | BoxGeometry | SphereGeometry | CapsuleGeometry | CylinderGeometry | ConeGeometry | GImpactGeometry | HullsGeometry | CompoundGeometry, motion: Motion, mass: float, center_of_mass: Sequence[float], inertia: Sequence[Sequence[float]], pose: Annotated[NDArray[numpy.float64], dict(shape=(4, 4))], material: BodyMaterial) -> int: ...

    def remove_body(self, arg: int, /) -> None: ...

    def add_joint(self, arg: JointSettings, /) -> int: ...

    def remove_joint(self, arg: int, /) -> None: ...

    def count_joint_turns_from(self, arg0: int, arg1: float, /) -> None: ...

    def read_joint(self, arg: int, /) -> JointReading: ...

    def joint_reaction(self, arg: int, /) -> tuple[list[float], list[float]]: ...

    def motor(self, arg: int, /) -> Motor: ...

    def set_motor(self, arg0: int, arg1: Motor, /) -> None: ...

    def gravity(self) -> list[float]: ...

    def set_gravity(self, arg: Sequence[float], /) -> None: ...

    def take_fast_spins(self) -> list[tuple[int, float]]: ...

    def take_long_ways(self) -> list[tuple[int, float]]: ...

    def find_lost_body(self) -> int | None: ...

    def timings(self) -> NDArray[numpy.float64]: ...

    def clear_timings(self) -> None: ...

    def contacts(self) -> NDArray[numpy.float64]: ...

    def find_contacts(self, arg0: int, arg1: int, arg2: float, /) -> NDArray[numpy.float64]: ...

    def cast_rays(self, arg0: Annotated[NDArray[numpy.float64], dict(shape=(None, 3), order='C', device='cpu', writable=False)], arg1: Annotated[NDArray[numpy.float64], dict(shape=(None, 3), order='C', device='cpu', writable=False)], /) -> NDArray[numpy.float64]: ...

    def bounds(self, arg: int, /) -> tuple[list[float], list[float]]: ...

    def pose(self, arg: int, /) -> NDArray[numpy.float64]: ...

    def set_pose(self, arg0: int, arg1: Annotated[NDArray[numpy.float64], dict(shape=(4, 4))], /) -> None: ...

    def place(self, arg0: int, arg1: Annotated[NDArray[numpy.float64], dict(shape=(4, 4))], /) -> None: ...

    def linear_velocity(self, arg: int, /) -> list[float]: ...

    def angular_velocity(self, arg: int, /) -> list[float]: ...

    def set_linear_velocity(self, arg0: int, arg1: Sequence[float], /) -> None: ...

    def set_angular_velocity(self, arg0: int, arg1: Sequence[float], /) -> None: ...

    def apply_force(self, arg0: int, arg1: Sequence[float], arg2: Sequence[float] | None, /) -> None: ...

    def apply_torque(self, arg0: int, arg1: Sequence[float], /) -> None: ...

    def apply_impulse(self, arg0: int, arg1: Sequence[float], arg2: Sequence[float] | None, /) -> None: ...

    def apply_torque_impulse(self, arg0: int, arg1: Sequence[float], /) -> None: ...

    def material(self, arg: int, /) -> BodyMaterial: ...

    def set_material(self, arg0: int, arg1: BodyMaterial, /) -> None: ...

    def set_collision(self, arg0: int, arg1: int, arg2: bool, /) -> None: ...

    def step_count(self) -> int: ...

    def save(self) -> SimulationState: ...

    def restore(self, arg: SimulationState, /) -> None: ...

    def adopt(self, arg: SimulationState, /) -> SimulationState: ...

    def is_asleep(self, arg: int, /) -> bool: ...

    def wake(self, arg: int, /) -> None: ...

most_timings: int = 100000

bullet_version: int = 324
