"""Two gears in mesh, one driven: whether they transmit a full turn, at the ratio of their teeth."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from typing import TYPE_CHECKING, Literal

import numpy as np
from voxshell.base.arguments import as_integer, as_positive
from voxshell.errors import SettingsError
from voxshell.model.model import Model
from voxshell.query.distances import distance
from voxshell.simulation.comparison_shapes import ConvexDecomposition, GImpact
from voxshell.simulation.joint_kinds import HingeJoint
from voxshell.simulation.world import World

from voxshell_studies.convex_parts import RECIPES, split
from voxshell_studies.hull_tables import tabulate_hulls
from voxshell_studies.motion import tabulate
from voxshell_studies.part import Part
from voxshell_studies.scenes.gear import make_gear
from voxshell_studies.scenes.solids import as_mesh

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray
    from voxshell.simulation.body_shapes import Shape

    from voxshell_studies.part import Columns, Tables

GearMethod = Literal["voxshell", "gimpact", "vhacd", "vhacd-64", "coacd", "coacd-fine"]
"""Models, Bullet's GImpact, and convex parts of :data:`voxshell_studies.convex_parts.RECIPES`. HACD
is missing: of a gear it finds only one part with a volume, at concavities from 1 to 100."""

NAMES = ("driven", "other")
STEP_COLUMNS = ("driven", "other", "contacts", "depth")
RECORDED_RATE = 60.0
"""Frames per second."""

_SPLITTING: dict[str, float] = {"vhacd": 10.0, "vhacd-64": 40.0, "coacd": 60.0, "coacd-fine": 100.0}
"""Approximate time to decompose both gears, seconds."""


@dataclass(frozen=True)
class GearsSettings:
    """Settings of the pair of gears.

    Attributes:
        module: Module of the teeth, meters.
        teeth: Numbers of teeth of the gear with the motor and of the other.
        width: Meters.
        bore: Radius of the holes, meters.
        backlash: Backlash along the pitch circle, of each gear, meters.
        voxel_size: Meters.
        rate: Steps per second.
        speed: Speed of the driven gear, turns per second.
        torque: Largest torque of its motor, newton meters.
        load: Torque that resists the other gear, newton meters.
        masses: Kilograms.
        friction: Friction of the teeth.
        margin: Collision margin of GImpact, meters; convex parts have none.
        methods: Methods whose gears turn.

    Raises:
        SettingsError: A number is out of range.
        MissingExtraError: manifold3d is not installed, when the shapes are built.
    """

    module: float = 0.002
    teeth: tuple[int, ...] = (12, 24)
    width: float = 0.008
    bore: float = 0.004
    backlash: float = 0.0002
    voxel_size: float = 0.0002
    rate: float = 500.0
    speed: float = 1.0
    torque: float = 0.05
    load: float = 0.01
    masses: tuple[float, ...] = (0.05, 0.2)
    friction: float = 0.1
    margin: float = 0.00005
    methods: tuple[GearMethod, ...] = (
        *("voxshell", "gimpact"),
        *("vhacd", "vhacd-64", "coacd", "coacd-fine"),
    )

    def __post_init__(self) -> None:
        for name in (
            *("module", "width", "bore", "voxel_size", "rate", "speed"),
            *("torque", "load", "friction"),
        ):
            as_positive(getattr(self, name), name)
        for name in ("teeth", "masses"):
            if len(getattr(self, name)) != 2:
                raise SettingsError(f"{name} must be two numbers, not {len(getattr(self, name))}")
        for teeth, mass in zip(self.teeth, self.masses, strict=True):
            as_integer(teeth, "teeth", 6, 1000)
            as_positive(mass, "masses")
        for name in ("backlash", "margin"):
            if not 0.0 <= getattr(self, name) < self.module:
                raise SettingsError(f"{name} must be at least 0 and below module")

    @property
    def ratio(self) -> float:
        """Turns of the driven gear for each turn of the other."""
        return self.teeth[1] / self.teeth[0]

    @property
    def distance(self) -> float:
        """Distance between the axes, meters."""
        return 0.5 * self.module * sum(self.teeth)

    @property
    def seconds(self) -> float:
        """Time limit for the other gear's turn, seconds: a quarter more than it should take."""
        return 1.25 * self.ratio / self.speed

    @property
    def recorded_every(self) -> int:
        """Steps between the frames of a recording."""
        return max(round(self.rate / RECORDED_RATE), 1)

    def build_models(self) -> tuple[Model, Model]:
        """Return the gear with the motor and the other, each about its own z."""
        return _build_models(self)

    def compute_start(self) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Return both poses, (4, 4): a gap of the second is opposite a tooth of the first."""
        from trimesh.transformations import rotation_matrix

        # A tooth is along its own x axis; with an odd number, a gap is on the other side.
        angle = np.pi / self.teeth[1] if self.teeth[1] % 2 == 0 else 0.0
        second = np.array(rotation_matrix(angle, (0.0, 0.0, 1.0)))
        second[0, 3] = self.distance
        return np.eye(4), second


@cache
def _build_models(settings: GearsSettings) -> tuple[Model, Model]:
    first, second = (
        Model.from_mesh(
            as_mesh(make_gear(teeth, settings.module, settings.width, settings.bore, settings.backlash)),
            voxel_size=settings.voxel_size,
        )
        for teeth in settings.teeth
    )  # fmt: skip
    return first, second


def plan(settings: GearsSettings) -> list[Part]:
    """Return a part for each method."""
    steps = settings.rate * settings.seconds
    return [
        Part(
            method,
            turn_gears,
            # The library's version is included, so a missing library makes the part run after
            # installation.
            {"settings": settings, "method": method, "library": _identify(method)},
            cost=1e-3 * steps + _SPLITTING.get(method, 0.0),
        )
        for method in settings.methods
    ]


def _identify(method: GearMethod) -> str:
    """Return the library that decomposes the gears; "" if none does, or it is not installed."""
    recipe = RECIPES.get(method)
    return recipe.identity if recipe is not None and recipe.version is not None else ""


def turn_gears(settings: GearsSettings, method: GearMethod, library: str) -> Tables:
    """Turn the gears of one method.

    Args:
        settings: Settings of the pair.
        method: The method whose shapes the gears have.
        library: The library that decomposes them; "" if none does, or it is not installed.

    Returns:
        "steps": turns of both, contacts, and the deepest that the method reports, meters; "frames":
        the overlap of our models in the same poses, whatever shapes collided, meters; "hulls":
        points of convex parts; and the recording. All are empty where the library is missing.
    """
    if method in RECIPES and not library:
        return {"steps": {name: np.empty(0) for name in STEP_COLUMNS}}
    models = settings.build_models()
    shapes, hulls = _build_shapes(settings, method, models)
    world = World(
        shell="fewest",
        gravity=(0.0, 0.0, 0.0),
        time_step=1.0 / settings.rate,
        sleeping=False,
        friction_directions=2 if method == "voxshell" else 1,
    )
    bodies = [
        world.add(
            shape,
            mass=mass,
            pose=pose,
            friction=settings.friction,
            inertia=model.mass_properties(mass),
            name=name,
        )
        for name, shape, model, mass, pose in zip(
            NAMES, shapes, models, settings.masses, settings.compute_start(), strict=True
        )
    ]
    hinges = [
        world.add_joint(HingeJoint(friction=friction), None, body)
        for friction, body in zip((0.0, settings.load), bodies, strict=True)
    ]
    hinges[0].set_target_velocity(2.0 * np.pi * settings.speed, max_force=settings.torque)
    recorder = world.record(every=settings.recorded_every)
    rows, overlaps = [], []
    for step in range(round(settings.seconds * settings.rate)):
        if step % settings.recorded_every == 0:
            overlaps.append(
                -distance(*models, bodies[0].pose, bodies[1].pose, shell="fewest").distance
            )
        world.step()
        found = world.contacts()
        turned = [hinge.position / (2.0 * np.pi) for hinge in hinges]
        rows.append((*turned, len(found), max(float(found["depth"].max(initial=0.0)), 0.0)))
    return {
        "steps": dict(zip(STEP_COLUMNS, np.array(rows).T, strict=True)),
        "frames": {"overlap": np.array(overlaps)},
        "hulls": hulls,
        **tabulate(recorder.recording()),
    }


def _build_shapes(
    settings: GearsSettings, method: GearMethod, models: tuple[Model, Model]
) -> tuple[Sequence[Shape], Columns]:
    if method == "voxshell":
        return models, tabulate_hulls({})
    if method == "gimpact":
        shapes = [GImpact(model.mesh, margin=settings.margin) for model in models]
        return shapes, tabulate_hulls({})
    split_gears = [split(model.mesh, RECIPES[method]).hulls for model in models]
    shapes = [ConvexDecomposition(hulls, margin=0.0) for hulls in split_gears]
    return shapes, tabulate_hulls(dict(zip(NAMES, split_gears, strict=True)))
