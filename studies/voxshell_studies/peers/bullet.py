"""Bullet in :class:`voxshell.World`: its own shapes, and voxshell's models for comparison."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from voxshell import Box, ConvexDecomposition, ConvexHull, GImpact, Plane, World
from voxshell.errors import SettingsError
from voxshell.simulation.body_shapes import mesh_of
from voxshell.simulation.world import BULLET_VERSION

from voxshell_studies.peers import ours
from voxshell_studies.scenes.drop import BULLET_MARGIN, choose_bullet_solver

if TYPE_CHECKING:
    from numpy.typing import NDArray
    from voxshell.simulation.body import Body
    from voxshell.simulation.body_shapes import Shape

    from voxshell_studies.peers.protocol import Case, Job, Other

CASE_MARGIN = 0.0
"""Bullet's collision margin in queries, meters; any other would add to the depths."""


def set_up(job: Job, variant: str) -> Worlds:
    """Return a contender that steps a world.

    Args:
        job: The job.
        variant: "voxels" or "analytic": models, on a model or on Bullet's plane and box;
            "gimpact", "hull" or "parts": Bullet's own.
    """
    return Worlds(job, variant)


class Worlds:
    """A world for each case and drop."""

    timed = "Bullet's narrow phase of the pair, from within"

    def __init__(self, job: Job, variant: str) -> None:
        self.version = BULLET_VERSION
        self._job = job
        self._is_model = variant in ("voxels", "analytic")
        self._solver = {} if self._is_model else choose_bullet_solver(variant)
        self._has_pairs = variant != "analytic"
        below = np.eye(4)
        below[2, 3] = -job.box_half_extents[2]
        box = Box(job.box_half_extents)
        self._grounds: dict[str, tuple[Shape, NDArray[np.float64]]] = {
            "plane": (Plane(), np.eye(4)),
            "box": (box, below),
        }
        if self._is_model:
            body, grounds = ours.make_shapes(job, variant)
            self._grounds.update(grounds)
            self._asked: Shape = body
            self._dropped: Shape = body
            self.settings: dict[str, object] = ours.describe_models(body, variant) | {
                "contacts": "segmented, level 4"
            }
            return
        self._asked = _make_shape(job, variant, CASE_MARGIN)
        self._dropped = _make_shape(job, variant, BULLET_MARGIN)
        self.settings = {
            "margin": CASE_MARGIN,
            "drops": f"margin {BULLET_MARGIN * 1e3:g} mm, Bullet's split impulse",
        }
        if variant == "gimpact":
            # GImpact finds a box's contacts a hundred times faster if the box consists of
            # triangles, too.
            self._grounds["box"] = (GImpact(mesh_of(box), margin=CASE_MARGIN), below)
            self.settings["box"] = "12 triangles"
        elif variant == "hull":
            self.settings["vertices"] = len(_hull_of(job))
        else:
            self.settings["parts"] = len(job.parts)

    def meet(self, case: Case) -> _Query | None:
        """Return the pair of a case."""
        if case.other == "body":
            if not self._has_pairs:
                return None
            return _Query(self._world(1.0 / 200.0), self._asked, self._asked, case.other_pose)
        ground, pose = self._grounds[case.other]
        return _Query(self._world(1.0 / 200.0), self._asked, ground, pose)

    def drop(self, other: Other, rate: float) -> _Fall | None:
        """Return the body above the plane or the box."""
        world = self._world(1.0 / rate, gravity=True)
        ground, pose = self._grounds[other]
        world.add(ground, mass=0.0, pose=pose)
        body = world.add(
            self._dropped, mass=1.0, pose=self._job.drop_pose, inertia=self._job.mass_properties
        )
        return _Fall(world, body)

    def _world(self, time_step: float, *, gravity: bool = False) -> World:
        return World(
            shell="fewest",
            gravity=(0.0, 0.0, -9.81 if gravity else 0.0),
            time_step=time_step,
            sleeping=False,
            **self._solver,
        )


class _Query:
    """A step of a world without gravity, in which the body rests at the queried pose."""

    def __init__(
        self, world: World, body: Shape, other: Shape, other_pose: NDArray[np.float64]
    ) -> None:
        self._world = world
        # Added first, so that the first of two equal models is the shell, as in ours.py.
        self._body = world.add(body)
        world.add(other, mass=0.0, pose=other_pose)

    def ask(self, pose: NDArray[np.float64]) -> float:
        self._body.pose = pose
        self._body.linear_velocity = self._body.angular_velocity = (0.0, 0.0, 0.0)
        self._world.step()
        return float(self._world.timings["narrow_phase"][-1])

    def answer(self) -> tuple[int, float | None]:
        depths = self._world.contacts()["depth"]
        return len(depths), float(depths.max(initial=0.0))


class _Fall:
    def __init__(self, world: World, body: Body) -> None:
        self._world = world
        self._body = body

    def step(self) -> NDArray[np.float64]:
        self._world.step()
        return self._body.pose


def _make_shape(job: Job, variant: str, margin: float) -> Shape:
    match variant:
        case "gimpact":
            return GImpact(job.mesh, margin=margin)
        case "hull":
            return ConvexHull(_hull_of(job), margin=margin)
        case "parts":
            return ConvexDecomposition(job.parts, margin=margin)
    raise SettingsError(f"Bullet has no variant {variant!r}")


def _hull_of(job: Job) -> NDArray[np.float64]:
    """Return only the vertices of the hull: points inside cost time."""
    return ConvexHull(job.mesh.vertices).mesh.vertices
