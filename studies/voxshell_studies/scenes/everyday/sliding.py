"""Bodies that slide, stop, and hold on slopes; smooth grounds and seams; tipping."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np
from voxshell_studies.scenes.everyday import forms, laws
from voxshell_studies.scenes.everyday.scene import (
    EverydayScene,
    Item,
    Measure,
    Stage,
    Y,
    Z,
    heading,
    scatter,
    shift,
    turn,
)

if TYPE_CHECKING:
    from collections.abc import Callable

    from voxshell_studies.scenes.everyday.scene import Form, Track

SLIDE, HOLD, SMOOTH, TIP = (
    "Sliding and stopping",
    "Holding on slopes",
    "Smooth grounds and seams",
    "Tipping",
)
COULOMB = "Coulomb friction; a textbook's closed form, summed over semi-implicit Euler steps"


def on_ramp(
    form: Form,
    ground: Form,
    slope: float,
    placement: int,
    *,
    friction: float,
    at: float = 0.0,
    speed: float = 0.0,
    settle: bool = False,
    mass: float = 1.0,
    spin: tuple[float, float, float] = (0.0, 0.0, 0.0),
    yaw: float | None = None,
    facts: dict[str, float] | None = None,
) -> Stage:
    """A body on a ramp that falls toward a heading.

    The placement turns the ramp's direction in the world, the ground about its own normal, and the body
    about the ramp's normal, so that neither axes nor grids favor a direction.

    Args:
        form: Of the body.
        ground: The half-space, or a slab with its upper face at z = 0.
        slope: Of the ramp, radians.
        placement: Which one.
        friction: Of the pair.
        at: Where the body starts, meters from the ground's middle, downhill positive.
        speed: At the start, downhill, m/s.
        settle: Whether the body stands on its most stable face instead of as it was modeled.
        mass: Kilograms.
        spin: Of the body at the start, rad/s, ramp frame.
        yaw: Of the body about the ramp's normal, radians; by default another one for each placement.
        facts: More numbers for the truth.
    """
    ramp = turn(Z, heading(placement)) @ turn(Y, slope)
    if yaw is None:
        yaw = heading(3 * placement)
    stand = forms.settled(form) if settle else forms.standing(form)
    pose = ramp @ shift(at, 0.0, 0.0) @ turn(Z, yaw) @ stand
    velocity = ramp[:3, 0] * speed
    angular = ramp[:3, :3] @ spin
    return Stage(
        (
            Item("ground", ground, ramp @ turn(Z, heading(7 * placement)), mass=0.0),
            Item("body", form, pose, mass, velocity=as_vector(velocity), spin=as_vector(angular)),
        ),
        friction=friction,
        facts={"slope": slope, "friction": friction, "speed": speed, **(facts or {})},
        world_from_ramp=ramp[:3, :3],
    )


def as_vector(values: np.ndarray) -> tuple[float, float, float]:
    """Three numbers as a tuple."""
    x, y, z = values.tolist()
    return x, y, z


def downhill(track: Track) -> float:
    """How far the body got downhill, meters."""
    return float(track.path("body")[-1, 0])


def slid_way(track: Track) -> float:
    """How far it should, meters."""
    pull = laws.slide_acceleration(track.fact("slope"), track.fact("friction"))
    return laws.way(track.fact("speed"), pull, track.seconds, track.time_step)


def stop_way(track: Track) -> float:
    """How far a body that is pushed on the level should get, meters."""
    loss = track.fact("friction") * laws.G
    return laws.way_to_stop(track.fact("speed"), loss, track.time_step)


def nothing(_: Track) -> float:
    """The truth of what must not happen."""
    return 0.0


def one(_: Track) -> float:
    """The truth of what must happen."""
    return 1.0


def farthest(track: Track) -> float:
    """The largest distance of the body's origin from its start, meters."""
    return float(np.linalg.norm(track.path("body"), axis=1).max())


def _slides(
    name: str,
    form: Callable[[], Form],
    ground: Callable[[], Form],
    degrees: float,
    mu: float,
    *,
    settle: bool = False,
    shown: bool = False,
) -> EverydayScene:
    return EverydayScene(
        name,
        SLIDE,
        f"{COULOMB}: distance with a = g (sin {degrees:g} deg - {mu:g} cos {degrees:g} deg) from rest.",
        lambda i: on_ramp(
            form(), ground(), math.radians(degrees), i, friction=mu, at=-0.3, settle=settle
        ),
        0.8,
        (Measure("distance", "m", downhill, slid_way, 0.05, relative=True),),
        shown=shown,
    )


def _stops(
    name: str,
    form: Callable[[], Form],
    ground: Callable[[], Form],
    mu: float,
    *,
    settle: bool = False,
) -> EverydayScene:
    return EverydayScene(
        name,
        SLIDE,
        f"{COULOMB}: a body pushed at 1 m/s stops after v2 / (2 mu g), mu {mu:g}.",
        lambda i: on_ramp(form(), ground(), 0.0, i, friction=mu, at=-0.1, speed=1.0, settle=settle),
        1.5,
        (Measure("stopping distance", "mm", downhill, stop_way, 0.05, relative=True, scale=1e3),),
    )


def _plane() -> Form:
    return forms.PLANE


def _slab() -> Form:
    return forms.slab(2.0)


def _cube() -> Form:
    return forms.box(0.1, 0.1, 0.1)


def _can() -> Form:
    return forms.cylinder(0.033, 0.115)


def _bunny() -> Form:
    return forms.named("bunny 0.2 m")


def _dented() -> Form:
    return forms.named("dented box")


def _holds(
    name: str,
    form: Callable[[], Form],
    ground: Callable[[], Form],
    mu: float,
    *,
    settle: bool = False,
) -> EverydayScene:
    slope = 0.95 * math.atan(mu)
    return EverydayScene(
        name,
        HOLD,
        f"Below the friction angle nothing moves (Coulomb): slope 0.95 atan {mu:g}.",
        lambda i: on_ramp(form(), ground(), slope, i, friction=mu, settle=settle),
        60.0,
        (Measure("creep", "mm", farthest, nothing, 1e-4, scale=1e3),),
        most=5,
    )


# ---- smooth --------------------------------------------------------------------------------------


def end_speed(track: Track) -> float:
    """Along the ramp's x axis after the last step, m/s."""
    return float(track.velocities["body"][-1] @ track.stage.world_from_ramp[:, 0])


def _hop(track: Track) -> float:
    return float(np.abs(track.path("body")[:, 2]).max())


def most_turned(track: Track) -> float:
    """The largest rotation of the body since its start, degrees."""
    return float(np.degrees(track.turned("body").max()))


def start_speed(track: Track) -> float:
    """The speed that must not change, m/s."""
    return track.fact("speed")


GLIDE = (
    Measure("speed", "m/s", end_speed, start_speed, 0.02, relative=True),
    Measure("largest change of height", "mm", _hop, nothing, 3e-4, scale=1e3),
    Measure("largest turn", "degrees", most_turned, nothing, 1.0),
)
NEWTON = "Without friction nothing changes a velocity along a flat ground (Newton's first law)."


def _glides(length: float, speed: float, seconds: float) -> EverydayScene:
    return EverydayScene(
        f"cube of 0.1 m glides on a slab of {length:g} m",
        SMOOTH,
        NEWTON,
        lambda i: on_ramp(
            _cube(),
            forms.slab(length),
            0.0,
            i,
            friction=0.0,
            at=-0.5 * speed * seconds,
            speed=speed,
        ),
        seconds,
        GLIDE,
    )


def _over_seam(form: Form, placement: int, speed: float) -> Stage:
    """Across the seam of two flush slabs of 1 m; the body's yaw and its distance from the axis vary."""
    half = forms.slab(1.0)
    pose = shift(-0.3, 0.1 * scatter(placement), 0.0) @ turn(Z, heading(placement))
    return Stage(
        (
            Item("first slab", half, shift(-0.5, 0.0, 0.0), mass=0.0),
            Item("second slab", half, shift(0.5, 0.0, 0.0), mass=0.0),
            Item("body", form, pose @ forms.standing(form), velocity=(speed, 0.0, 0.0)),
        ),
        friction=0.0,
        facts={"speed": speed},
    )


# ---- tipping -------------------------------------------------------------------------------------


def _tall_box(placement: int, mu: float, degrees: float) -> Stage:
    """A box 0.04 m wide and 0.1 m high, one of its edges across the slope."""
    form = forms.box(0.04, 0.04, 0.1)
    return on_ramp(
        form, forms.PLANE, math.radians(degrees), placement, friction=mu, at=-0.3, yaw=0.0
    )


def _most_tilted(track: Track) -> float:
    """The largest angle between the body's axis and the ramp's normal, radians; turns about that are none."""
    axes = track.poses["body"][:, :3, 2] @ track.stage.world_from_ramp[:, 2]
    return float(np.arccos(np.clip(axes, -1.0, 1.0)).max())


def _has_tipped(track: Track) -> float:
    return float(_most_tilted(track) > math.radians(45.0))


def _has_not_tipped(track: Track) -> float:
    return float(_most_tilted(track) < math.radians(5.0))


SCENES = (
    _slides("cube slides down 35 degrees, plane", _cube, _plane, 35.0, 0.5, shown=True),
    _slides("cube slides down 35 degrees, slab", _cube, _slab, 35.0, 0.5),
    _slides("cube slides down 42 degrees at friction 0.7, plane", _cube, _plane, 42.0, 0.7),
    _slides("mug slides down 35 degrees, plane", forms.mug, _plane, 35.0, 0.5),
    _slides("mug slides down 35 degrees, slab", forms.mug, _slab, 35.0, 0.5),
    _slides("can slides down 30 degrees at friction 0.4, slab", _can, _slab, 30.0, 0.4),
    # Its center is 73 mm over the ground and 14 mm from the nearest edge of its base: at friction 0.2 it tips.
    _slides(
        "bunny slides down 20 degrees at friction 0.15, plane",
        _bunny,
        _plane,
        20.0,
        0.15,
        settle=True,
    ),
    _slides("dented box slides down 35 degrees, slab", _dented, _slab, 35.0, 0.5),
    _stops("cube stops, plane", _cube, _plane, 0.5),
    _stops("cube stops, slab", _cube, _slab, 0.5),
    _stops("mug stops, slab", forms.mug, _slab, 0.5),
    _stops("can stops, plane", _can, _plane, 0.4),
    _stops("bunny stops, slab", _bunny, _slab, 0.15, settle=True),
    _stops("dented box stops, plane", _dented, _plane, 0.5),
    _holds("cube holds on a slope, plane", _cube, _plane, 0.5),
    _holds("mug holds on a slope, slab", forms.mug, _slab, 0.5),
    _holds("dented box holds on a slope, slab", _dented, _slab, 0.5),
    _glides(0.3, 0.5, 0.2),
    _glides(0.5, 0.5, 0.6),
    _glides(1.0, 0.5, 1.2),
    EverydayScene(
        "cube crosses the seam of two slabs",
        SMOOTH,
        NEWTON,
        lambda i: _over_seam(_cube(), i, 1.0),
        0.6,
        GLIDE,
        shown=True,
    ),
    EverydayScene(
        "mug crosses the seam of two slabs",
        SMOOTH,
        NEWTON,
        lambda i: _over_seam(forms.mug(), i, 1.0),
        0.6,
        GLIDE,
    ),
    EverydayScene(
        "tall box slides, does not tip",
        TIP,
        "Width over height is 0.4: it tips only where friction and slope exceed that. Friction 0.3, 30 degrees.",
        lambda i: _tall_box(i, 0.3, 30.0),
        0.6,
        (
            Measure("stays upright", "", _has_not_tipped, one, 0.0),
            Measure("distance", "m", downhill, slid_way, 0.05, relative=True),
        ),
    ),
    EverydayScene(
        "tall box tips, does not slide",
        TIP,
        "Width over height is 0.4: it tips where friction and slope exceed that. Friction 0.8, 25 degrees.",
        lambda i: _tall_box(i, 0.8, 25.0),
        2.0,
        (Measure("tips over", "", _has_tipped, one, 0.0),),
    ),
    EverydayScene(
        "tall box stands on a slope",
        TIP,
        "Width over height is 0.4 = tan 21.8 degrees: at 19 degrees and friction 0.8 it stands.",
        lambda i: _tall_box(i, 0.8, 19.0),
        10.0,
        (Measure("creep", "mm", farthest, nothing, 1e-4, scale=1e3),),
        most=5,
    ),
)
