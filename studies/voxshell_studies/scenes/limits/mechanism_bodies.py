"""Solids of mechanisms: yokes, Geneva drives, couplings, bricks with studs and keyhole plates. Meters."""

from __future__ import annotations

import math
from functools import cache
from typing import TYPE_CHECKING, Any

from voxshell_studies.scenes.everyday.scene import Form, Z, turn
from voxshell_studies.scenes.gear import make_gear
from voxshell_studies.scenes.solids import as_mesh, import_manifold

if TYPE_CHECKING:
    from collections.abc import Sequence

THICK = 0.01
"""Thickness of plates; they are between z = 0 and this."""

_ROUND = 128
"""Segments of a full turn."""

# ---- pieces --------------------------------------------------------------------------------------


def _disc(radius: float, low: float, high: float, x: float = 0.0, y: float = 0.0) -> Any:
    return (
        import_manifold()
        .Manifold.cylinder(high - low, radius, radius, _ROUND)
        .translate((x, y, low))
    )


def _block(x: Sequence[float], y: Sequence[float], z: Sequence[float]) -> Any:
    size = (x[1] - x[0], y[1] - y[0], z[1] - z[0])
    return import_manifold().Manifold.cube(size).translate((x[0], y[0], z[0]))


def _turned(solid: Any, angle: float) -> Any:
    return solid.transform(turn(Z, angle)[:3].tolist())


# ---- Scotch yoke ---------------------------------------------------------------------------------

CRANK, PIN = 0.03, 0.004
"""Distance of a pin from its axis, and its radius."""


@cache
def crank() -> Form:
    """A disc below z = 0 with a pin upward at x = CRANK."""
    disc = _disc(CRANK + 0.01, -THICK, 0.0)
    return Form("crank", as_mesh(disc + _disc(PIN, -0.5 * THICK, THICK, CRANK)))


@cache
def yoke(play: float) -> Form:
    """A plate with a slot along y, wider than the pin by ``play``."""
    half = PIN + 0.5 * play
    plate = _block((-0.02, 0.02), (-0.05, 0.05), (0.001, THICK))
    slot = _block((-half, half), (-0.04, 0.04), (0.0, 2.0 * THICK))
    return Form(f"yoke {play:g}", as_mesh(plate - slot))


# ---- Geneva drive --------------------------------------------------------------------------------

GENEVA = 0.08
"""Distance of the two axes."""
_GENEVA_RADIUS = GENEVA * math.sqrt(0.5)
"""Of the wheel, and of the pin's circle."""
_LOCK = 0.04
"""Radius of the driver's disc that holds the wheel."""


@cache
def geneva_wheel(play: float) -> Form:
    """A wheel with four slots, along x and y, and hollows between them that the driver's disc holds."""
    wheel = _disc(_GENEVA_RADIUS, 0.0, THICK)
    half = PIN + 0.5 * play
    depth = GENEVA - _GENEVA_RADIUS - PIN - play
    slot = _block((depth, GENEVA), (-half, half), (-THICK, 2.0 * THICK))
    hollow = _disc(_LOCK + 0.5 * play, -THICK, 2.0 * THICK, GENEVA)
    for i in range(4):
        wheel -= _turned(slot, 0.5 * math.pi * i)
        wheel -= _turned(hollow, 0.5 * math.pi * (i + 0.5))
    return Form(f"geneva wheel {play:g}", as_mesh(wheel))


@cache
def geneva_driver() -> Form:
    """An arm below the wheel with a pin along x, and a disc with a gap on the side of the pin."""
    arm = _block((-0.01, _GENEVA_RADIUS + 0.01), (-0.008, 0.008), (-0.011, -0.001))
    pin = _disc(PIN, -0.006, THICK, _GENEVA_RADIUS)
    gap = _disc(_GENEVA_RADIUS + 0.002, -THICK, 2.0 * THICK, GENEVA)
    lock = _disc(_LOCK, -0.006, THICK) - gap
    return Form("geneva driver", as_mesh(arm + pin + lock))


# ---- Oldham coupling -----------------------------------------------------------------------------

_HUB, _TONGUE = 0.03, 0.004
"""Radius of the three discs, and half the width of a tongue."""


@cache
def hub(play: float) -> Form:
    """A disc with a groove along x in its upper face, z = THICK; ``play`` wider than a tongue."""
    half = _TONGUE + 0.5 * play
    groove = _block((-1.0, 1.0), (-half, half), (0.5 * THICK, 2.0 * THICK))
    return Form(f"hub {play:g}", as_mesh(_disc(_HUB, 0.0, THICK) - groove))


@cache
def middle_disc() -> Form:
    """A disc with a tongue along x below, and one along y above."""
    disc = _disc(_HUB, 0.0, THICK)
    ends = _HUB - 0.006
    below = _block((-ends, ends), (-_TONGUE, _TONGUE), (-0.4 * THICK, 0.5 * THICK))
    above = _block((-_TONGUE, _TONGUE), (-ends, ends), (0.5 * THICK, 1.4 * THICK))
    return Form("middle disc", as_mesh(disc + below + above))


# ---- bricks and keyholes -------------------------------------------------------------------------

STUD_HEIGHT = 0.002


@cache
def brick(play: float) -> Form:
    """A brick of 16 by 16 by 10 mm with four studs above and a hollow below that fits these.

    Its body is between z = 0 and 10 mm. The walls leave the studs ``play`` in all.
    """
    reach = 0.004 + 0.0025 + 0.5 * play
    solid = _block((-0.008, 0.008), (-0.008, 0.008), (0.0, 0.01))
    solid -= _block((-reach, reach), (-reach, reach), (-0.01, 0.008))
    for x in (-0.004, 0.004):
        for y in (-0.004, 0.004):
            solid += _disc(0.0025, 0.009, 0.01 + STUD_HEIGHT, x, y)
    return Form(f"brick {play:g}", as_mesh(solid))


@cache
def screw() -> Form:
    """A shaft of 4 mm from z = 0 up, with a head of 9 mm between z = 8 and 11 mm."""
    return Form("screw", as_mesh(_disc(0.002, 0.0, 0.009) + _disc(0.0045, 0.008, 0.011)))


@cache
def keyhole_plate() -> Form:
    """A plate of 3 mm with a hole of 10 mm, and a slot of 5 mm from it along y whose end is the origin."""
    plate = _block((-0.02, 0.02), (-0.03, 0.02), (0.0, 0.003))
    slot = _block((-0.0025, 0.0025), (-0.015, 0.0), (-0.01, 0.01)) + _disc(0.0025, -0.01, 0.01)
    return Form("keyhole plate", as_mesh(plate - slot - _disc(0.005, -0.01, 0.01, 0.0, -0.015)))


# ---- gears ---------------------------------------------------------------------------------------

MODULE = 0.002
TEETH = (12, 24)


@cache
def gear(teeth: int) -> Form:
    """A spur gear about z with a tooth along x and a backlash of a tenth of the module."""
    solid = make_gear(teeth, MODULE, 0.008, 0.004, 0.1 * MODULE)
    return Form(f"gear {teeth}", as_mesh(solid))
