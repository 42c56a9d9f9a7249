"""Objects of 5 mm to 0.2 m dropped on slabs, tables, stairs and terrains of 0.3 to 5 m."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from voxshell_studies.scenes.everyday import forms
from voxshell_studies.scenes.everyday.scene import (
    EverydayScene,
    Item,
    Measure,
    Stage,
    Z,
    heading,
    scatter,
    shift,
    turn,
)
from voxshell_studies.scenes.everyday.sliding import nothing, one
from voxshell_studies.scenes.geometry_bodies import make_body

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray
    from voxshell_studies.scenes.everyday.scene import Engine, Form, Track

LANDED = "Dropped objects"


def gap_to_flat(points: NDArray[np.float64]) -> NDArray[np.float64]:
    """From a ground at z = 0."""
    return points[:, 2]


def gap_to_stairs(points: NDArray[np.float64]) -> NDArray[np.float64]:
    """From eight steps of 0.25 m up along x, which begin at x = -1 with a tread at z = 0.

    Above a tread it is the height; inside a step, the shorter way out, up or through the riser.

    Example:
        >>> gap_to_stairs(np.array([[-0.9, 0.0, 0.1], [-0.74, 0.0, 0.2]])).round(3)
        array([ 0.1 , -0.01])
    """
    x, height = points[:, 0] + 1.0, points[:, 2]
    step = np.clip(np.floor(x / 0.25), 0.0, 7.0)
    up = height - 0.25 * step
    # The riser in front of this step is solid below the tread.
    back = np.where(step > 0.0, x - 0.25 * step, np.inf)
    inside = up < 0.0
    deep = np.minimum(-up, np.where(height > 0.25 * (step - 1.0), back, np.inf))
    return np.where(inside, -deep, up)


def gap_to_terrain(points: NDArray[np.float64]) -> NDArray[np.float64]:
    """Over the triangles of the terrain of 5 m, along z."""
    cells, length = 100, 5.0
    heights = make_body("terrain 5 m").vertices[: (cells + 1) ** 2, 2].reshape(cells + 1, cells + 1)
    place = (points[:, :2] / length + 0.5) * cells
    cell = np.clip(np.floor(place).astype(int), 0, cells - 1)
    u, v = (place - cell).T
    i, j = cell.T
    first, far = heights[i, j], heights[i + 1, j + 1]
    right, up = heights[i + 1, j], heights[i, j + 1]
    # Each cell's diagonal goes from its first to its far corner.
    lower = first + u * (right - first) + v * (far - right)
    upper = first + v * (up - first) + u * (far - up)
    return points[:, 2] - np.where(u >= v, lower, upper)


def _place(
    placement: int,
    form: Form,
    ground: Form,
    spread: float,
    gap: Callable[[NDArray[np.float64]], NDArray[np.float64]],
) -> Stage:
    """In any orientation, its lowest vertex 50 mm or its size over the ground, whichever is less."""
    rng = np.random.default_rng((7, placement))
    axis = rng.normal(size=3)
    axis /= np.linalg.norm(axis)
    x, y, z = axis.tolist()
    rotation = turn(Z, heading(placement)) @ turn((x, y, z), 3.0 * scatter(placement, 3))
    aside = shift(spread * scatter(placement), spread * scatter(placement, 2), 0.0)
    points = form.vertices @ rotation[:3, :3].T + aside[:3, 3]
    size = float(np.ptp(form.vertices, axis=0).max())
    # Down from above all grounds, first by 20 mm, then by 1 mm.
    low = 2.2
    for by in (0.02, 0.001):
        while float(gap(points + np.array((0.0, 0.0, low))).min()) > 0.0:
            low -= by
        low += by
    pose = shift(0.0, 0.0, low + min(0.05, size)) @ aside @ rotation
    return Stage(
        (Item("ground", ground, mass=0.0), Item("body", form, pose, 0.2)),
        restitution=0.2,
        facts={"size": size},
    )


def _lands(
    name: str,
    form: Callable[[], Form],
    ground: Callable[[], Form],
    spread: float,
    bar: float,
    gap: Callable[[NDArray[np.float64]], NDArray[np.float64]] = gap_to_flat,
    *,
    engines: tuple[Engine, ...] = ("voxshell", "bullet", "mujoco"),
    shown: bool = False,
) -> EverydayScene:
    """``bar``: the larger of 0.1 mm and 0.5 % of the object, on a terrain its tolerance, meters."""

    def lowest(track: Track) -> float:
        pose = track.poses["body"][-1]
        points = track.item("body").form.vertices @ pose[:3, :3].T + pose[:3, 3]
        return float(gap(points).min())

    def kept(track: Track) -> float:
        return float(track.poses["body"][-1][2, 3] > -0.3 - track.fact("size"))

    return EverydayScene(
        name,
        LANDED,
        "What is dropped on a ground lies on it: its lowest vertex touches the ground (2 s after a fall of at "
        "most 50 mm), and nothing is lost.",
        lambda i: _place(i, form(), ground(), spread, gap),
        2.0,
        (
            Measure("stays on the ground", "", kept, one, 0.0),
            Measure(
                "deepest vertex in the ground", "mm", lowest, nothing, bar, scale=1e3, signed=-1
            ),
        ),
        engines=engines,
        shown=shown,
    )


def _stairs() -> Form:
    """With a floor before the lowest tread and behind the highest one, so that nothing falls beside."""
    steps = tuple(
        ((0.125 + 0.25 * i - 1.0, 0.0, 0.5 * (0.25 * i - 0.25)), (0.25, 3.0, 0.25 * (i + 1)))
        for i in range(8)
    )
    floor = ((-1.875, 0.0, -0.125), (2.25, 3.0, 0.25))
    landing = ((1.375, 0.0, 0.75), (1.25, 3.0, 2.0))
    return forms.boxes("stairs of boxes", (*steps, floor, landing))


def _table() -> Form:
    legs = tuple(
        ((0.55 * x, 0.35 * y, -0.37), (0.05, 0.05, 0.7)) for x in (-1.0, 1.0) for y in (-1.0, 1.0)
    )
    return forms.boxes("table of five boxes", (((0.0, 0.0, -0.0125), (1.2, 0.8, 0.025)), *legs))


def _terrain() -> Form:
    # No convex parts represent it.
    form = forms.named("terrain 5 m")
    return type(form)(form.name, form.mesh)


_ALONE: tuple[Engine, ...] = ("voxshell",)

SCENES = (
    _lands(
        "cube of 5 mm on a slab of 0.3 m",
        lambda: forms.box(0.005, 0.005, 0.005),
        lambda: forms.slab(0.3),
        0.08,
        1e-4,
    ),
    _lands(
        "cube of 5 mm on a slab of 5 m",
        lambda: forms.box(0.005, 0.005, 0.005),
        lambda: forms.slab(5.0),
        2.2,
        1e-4,
    ),
    _lands("screw of 5 mm on a table", lambda: forms.named("screw 5 mm"), _table, 0.2, 1e-4),
    _lands(
        "ball of 30 mm on a slab of 1 m",
        lambda: forms.ball(0.015),
        lambda: forms.slab(1.0),
        0.3,
        1.5e-4,
    ),
    _lands(
        "cube of 50 mm on stairs of 2 m",
        lambda: forms.box(0.05, 0.05, 0.05),
        _stairs,
        0.8,
        2.5e-4,
        gap_to_stairs,
    ),
    _lands("mug on stairs of 2 m", forms.mug, _stairs, 0.8, 5e-4, gap_to_stairs, shown=True),
    _lands("mug on a table", forms.mug, _table, 0.15, 5e-4),
    _lands(
        "bunny of 0.2 m on a slab of 3 m",
        lambda: forms.named("bunny 0.2 m"),
        lambda: forms.slab(3.0),
        1.0,
        1e-3,
    ),
    _lands(
        "cube of 50 mm on a terrain of 5 m",
        lambda: forms.box(0.05, 0.05, 0.05),
        _terrain,
        1.8,
        1.25e-3,
        gap_to_terrain,
        engines=_ALONE,
    ),
    _lands(
        "bunny of 0.2 m on a terrain of 5 m",
        lambda: forms.named("bunny 0.2 m"),
        _terrain,
        1.8,
        1.25e-3,
        gap_to_terrain,
        engines=_ALONE,
    ),
)
