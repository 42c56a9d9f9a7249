"""Closed forms of impacts with friction, with edges, and of bodies that roll over edges. SI units and radians."""

from __future__ import annotations

import math

from voxshell_studies.scenes.everyday import laws


def prism_way(
    slope: float, sides: int, radius: float, inertia_ratio: float, seconds: float
) -> float:
    """How far a regular prism rolls down a slope from rest, meters, which begins on an edge.

    It turns about the edge that it stands on, and loses spin when the next edge lands: the new spin is
    (k + cos(2 pi / n)) / (k + 1) of the old one, k = I / (m r2) (the rimless wheel; McGeer, Passive
    dynamic walking, 1990). Integrated with steps of 0.1 ms.

    Args:
        slope: Radians, above pi / sides.
        sides: n.
        radius: r, of the edges, meters.
        inertia_ratio: k.
        seconds: How long.

    Example:
        >>> smooth = 0.5 * laws.roll_acceleration(0.2, 0.5) * 0.8**2
        >>> round(prism_way(0.2, 1000, 0.05, 0.5, 0.8) / smooth, 2)
        0.99
    """
    half = math.pi / sides
    kept = (inertia_ratio + math.cos(2.0 * half)) / (inertia_ratio + 1.0)
    angle, spin, landed = 0.0, 0.0, 0
    h = 1e-4
    for _ in range(round(seconds / h)):
        spin += h * laws.G * math.sin(slope + angle) / (radius * (inertia_ratio + 1.0))
        angle += h * spin
        while angle >= half:
            angle -= 2.0 * half
            spin *= kept
            landed += 1
    return radius * (2.0 * landed * math.sin(half) + math.sin(angle))


def rough_bounce(
    along: float,
    into: float,
    spin: float,
    radius: float,
    inertia_ratio: float,
    friction: float,
    restitution: float,
) -> tuple[float, float]:
    """Of a ball that hits a ground: Newton's law along the normal, Coulomb's across it.

    Friction's impulse stops the slip, or is mu (1 + e) times the speed into the ground where that does
    not suffice (Garwin, Am. J. Phys. 37, 88, 1969; Brach, Mechanical Impact Dynamics).

    Args:
        along: Speed along the ground, m/s.
        into: Speed into the ground, m/s.
        spin: About the axis across, in the sense of rolling forward, rad/s.
        radius: Meters.
        inertia_ratio: I / (m r2).
        friction: mu.
        restitution: e.

    Returns:
        Speed along the ground, m/s, and spin, rad/s, afterwards.

    Example:
        >>> along, spin = rough_bounce(1.0, 2.0, 0.0, 0.02, 0.4, 0.3, 0.7)
        >>> round(along, 4), round(spin * 0.02, 4)
        (0.7143, 0.7143)
    """
    slip = along - radius * spin
    stop = abs(slip) * inertia_ratio / (1.0 + inertia_ratio)
    change = math.copysign(min(stop, friction * (1.0 + restitution) * into), slip)
    return along - change, spin + change / (inertia_ratio * radius)


def rod_impact(
    speed: float, ball: float, rod: float, arm: float, inertia: float, restitution: float
) -> tuple[float, float, float]:
    """A ball that hits a free rod square, without friction.

    Impulse (1 + e) v / (1 / m + 1 / M + d2 / I) (Newton's law at the point of contact).

    Args:
        speed: Of the ball, m/s; the rod stands.
        ball: m, kilograms.
        rod: M, kilograms.
        arm: d, from the rod's center to the ball's path, meters.
        inertia: I, of the rod, across it, kg m2.
        restitution: e.

    Returns:
        Speeds of ball and rod, m/s, and the rod's spin, rad/s, afterwards.

    Example:
        >>> rod_impact(1.0, 1.0, 1.0, 0.0, 1.0, 1.0)
        (0.0, 1.0, 0.0)
    """
    impulse = (1.0 + restitution) * speed / (1.0 / ball + 1.0 / rod + arm**2 / inertia)
    return speed - impulse / ball, impulse / rod, impulse * arm / inertia


def trip_speed(side: float, curb: float) -> float:
    """Above which a cube that slides into a curb turns over it, m/s (a textbook's exercise).

    Without restitution its angular momentum about the curb's upper edge stays, m v a with a = s / 2 - c.
    The energy of what remains must lift the center from a over that edge to d = hypot(s / 2, a):
    v2 = 2 g (s2 / 6 + d2) (d - a) / a2, without a curb's height 8 (sqrt 2 - 1) g s / 3.

    Args:
        side: s, meters.
        curb: c, its height, meters.

    Example:
        >>> round(trip_speed(0.1, 0.0), 3), round(trip_speed(0.1, 0.002), 3)
        (1.041, 1.084)
    """
    arm = 0.5 * side - curb
    reach = math.hypot(0.5 * side, arm)
    return math.sqrt(2.0 * laws.G * (side**2 / 6.0 + reach**2) * (reach - arm)) / arm
