"""Closed forms of everyday scenes. SI units and radians.

Where time steps change the result, the form is that of semi-implicit Euler steps, which Bullet and MuJoCo
take: first the velocity, then the place with the new velocity.
"""

from __future__ import annotations

import math
from functools import cache

import numpy as np

G = 9.81
"""Gravity, m/s2."""


def slide_acceleration(slope: float, friction: float) -> float:
    """Down a slope with Coulomb friction: g (sin a - mu cos a), m/s2 (any textbook of mechanics).

    Example:
        >>> round(slide_acceleration(math.radians(35.0), 0.5), 3)
        1.609
    """
    return G * (math.sin(slope) - friction * math.cos(slope))


def roll_acceleration(slope: float, inertia_ratio: float) -> float:
    """Down a slope without sliding: g sin a / (1 + I / (m r2)), m/s2.

    Args:
        slope: Radians.
        inertia_ratio: I / (m r2), of the axis of rolling and the radius of rolling: 2/5 of a ball.
    """
    return G * math.sin(slope) / (1.0 + inertia_ratio)


def way(speed: float, acceleration: float, seconds: float, time_step: float) -> float:
    """Covered with a constant acceleration, meters: n v h + a h2 n (n + 1) / 2 after n steps h.

    Example:
        >>> round(way(0.0, 2.0, 1.0, 1e-4), 4), round(way(0.0, 2.0, 1.0, 0.1), 4)
        (1.0001, 1.1)
    """
    steps = round(seconds / time_step)
    return steps * speed * time_step + 0.5 * acceleration * time_step**2 * steps * (steps + 1)


def way_to_stop(speed: float, deceleration: float, time_step: float) -> float:
    """Until friction has stopped a body, meters: h times the sum of the speeds after each step.

    Without steps it is v2 / (2 a).

    Example:
        >>> round(way_to_stop(1.0, 0.5 * G, 1e-5), 4), round(way_to_stop(1.0, 0.5 * G, 1 / 30), 4)
        (0.1019, 0.0855)
    """
    loss = deceleration * time_step
    steps = math.floor(speed / loss)
    return time_step * (steps * speed - 0.5 * loss * steps * (steps + 1))


def bowled_speed(speed: float, inertia_ratio: float) -> float:
    """Of a ball that is bowled without spin, once it rolls: v / (1 + I / (m r2)), m/s; 5/7 v of a ball.

    Friction does not enter: the angular momentum about the contact's line stays.
    """
    return speed / (1.0 + inertia_ratio)


def ring_spin_down(spin: float, friction: float, outer: float, inner: float) -> float:
    """Seconds until a flat ring that spins about its vertical axis stands still.

    Uniform pressure: torque mu m g (2/3) (R3 - r3) / (R2 - r2), inertia m (R2 + r2) / 2. For a thin ring
    the pressure's distribution does not matter.
    """
    lever = 2.0 / 3.0 * (outer**3 - inner**3) / (outer**2 - inner**2)
    return spin * 0.5 * (outer**2 + inner**2) / (friction * G * lever)


def wedge_acceleration(slope: float, block: float, wedge: float) -> float:
    """Of a wedge on a floor while a block slides down it, both without friction, m/s2.

    m g sin a cos a / (M + m sin2 a) (Lagrange's equations; any textbook).

    Example:
        >>> round(wedge_acceleration(math.radians(30.0), 1.0, 1e9), 6)
        0.0
    """
    sine = math.sin(slope)
    return block * G * sine * math.cos(slope) / (wedge + block * sine**2)


def oblique_impact(
    speed: float, offset: float, radius: float, restitution: float
) -> tuple[float, float]:
    """Speeds of two equal smooth balls after one has hit the other, which stood.

    Along the line of centers (1 -+ e) / 2 of the component, across it all of it.

    Args:
        speed: Of the first, m/s.
        offset: Between its path and the other's center, meters.
        radius: Of both, meters.
        restitution: e.

    Returns:
        Speed of the one that came and of the one that stood, m/s.

    Example:
        >>> oblique_impact(1.0, 0.0, 0.1, 1.0)
        (0.0, 1.0)
    """
    sine = offset / (2.0 * radius)
    along = speed * math.sqrt(1.0 - sine**2)
    across = speed * sine
    return math.hypot(0.5 * (1.0 - restitution) * along, across), 0.5 * (1.0 + restitution) * along


def pendulum_period(length: float, amplitude: float) -> float:
    """Of a pendulum with any amplitude, seconds: 2 pi sqrt(l / g) / agm(1, cos(A / 2)) (Gauss).

    Args:
        length: Of the mathematical pendulum, I / (m d), meters.
        amplitude: Radians.

    Example:
        >>> round(pendulum_period(1.0, 1e-6), 4), round(pendulum_period(1.0, 1.0), 4)
        (2.0061, 2.1391)
    """
    a, b = 1.0, math.cos(0.5 * amplitude)
    for _ in range(40):
        a, b = 0.5 * (a + b), math.sqrt(a * b)
    return 2.0 * math.pi * math.sqrt(length / G) / a


def bowl_period(bowl: float, radius: float) -> float:
    """Of a ball that rolls to and fro in a bowl with small amplitude: 2 pi sqrt(7 (R - r) / (5 g)), s."""
    return 2.0 * math.pi * math.sqrt(1.4 * (bowl - radius) / G)


def precession(spin: float, axial: float, lateral: float, moment: float, tilt: float) -> float:
    """Slow steady precession of a heavy top about a fixed point, rad/s.

    The smaller root of I1 cos(t) W2 - I3 w W + M = 0 (Goldstein, Classical Mechanics, 5.7).

    Args:
        spin: w, angular velocity along the top's axis, rad/s.
        axial: I3, about the axis, kg m2.
        lateral: I1, about the fixed point across the axis, kg m2.
        moment: M = m g l, newton meters.
        tilt: t, of the axis from the vertical, radians.
    """
    a, b = lateral * math.cos(tilt), axial * spin
    return (b - math.sqrt(b * b - 4.0 * a * moment)) / (2.0 * a)


@cache
def tumble(
    inertia: tuple[float, float, float], spin: tuple[float, float, float], seconds: float
) -> tuple[tuple[float, ...], ...]:
    """The attitude of a free body, (3, 3) ``world_from_principal`` as rows, integrated with fine steps.

    Euler's equations and the attitude by Runge and Kutta's method of fourth order with steps of 1 ms:
    halving them changes the attitude after 30 s by less than 1e-6 rad.

    Args:
        inertia: Principal moments, kg m2.
        spin: Angular velocity at the start, rad/s, in principal axes, which coincide with the world's.
        seconds: How long.
    """
    i = np.array(inertia)
    # Quaternion w x y z and angular velocity in the body.
    state = np.array([1.0, 0.0, 0.0, 0.0, *spin])

    def rate(s: np.ndarray) -> np.ndarray:
        w, x, y, z, p, q, r = s.tolist()
        return np.array(
            [
                0.5 * (-x * p - y * q - z * r),
                0.5 * (w * p + y * r - z * q),
                0.5 * (w * q + z * p - x * r),
                0.5 * (w * r + x * q - y * p),
                (i[1] - i[2]) / i[0] * q * r,
                (i[2] - i[0]) / i[1] * r * p,
                (i[0] - i[1]) / i[2] * p * q,
            ]
        )

    steps = max(round(seconds / 1e-3), 1)
    h = seconds / steps
    for _ in range(steps):
        k1 = rate(state)
        k2 = rate(state + 0.5 * h * k1)
        k3 = rate(state + 0.5 * h * k2)
        k4 = rate(state + h * k3)
        state = state + h / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + k4)
    w, x, y, z = (state[:4] / np.linalg.norm(state[:4])).tolist()
    return (
        (1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)),
        (2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)),
        (2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)),
    )


def groove_acceleration(slope: float, friction: float, half_angle: float) -> float:
    """Along a V-groove that is inclined: g (sin a - mu cos a / sin b), m/s2.

    Two walls at an angle b from the groove's middle plane together press 1 / sin b times as hard as a
    flat ground (Dieter, Mechanical Metallurgy; any text on V-belts).

    Example:
        >>> round(groove_acceleration(math.radians(40.0), 0.3, math.pi / 2), 6) == round(
        ...     slide_acceleration(math.radians(40.0), 0.3), 6
        ... )
        True
    """
    return G * (math.sin(slope) - friction * math.cos(slope) / math.sin(half_angle))


def spinning_ring_way(
    speed: float, spin: float, friction: float, outer: float, inner: float, time_step: float
) -> float:
    """Until a flat ring that slides and spins at once stands still, meters.

    Each part of the ring feels friction against its own velocity, so a spin makes the friction against
    the slide smaller (Farkas et al., Phys. Rev. Lett. 90, 248302, 2003). Uniform pressure; integrated
    with steps of at most 0.1 ms, of which the velocity after each time step is summed.

    Example:
        >>> round(spinning_ring_way(1.0, 0.0, 0.3, 0.05, 0.045, 1e-4), 3)
        0.17
    """
    angles = (np.arange(48) + 0.5) * (2.0 * np.pi / 48)
    radius = math.sqrt(0.5 * (outer**2 + inner**2))
    x, y = radius * np.cos(angles), radius * np.sin(angles)
    parts = max(math.ceil(time_step / 1e-4), 1)
    h = time_step / parts
    covered = 0.0
    while speed > 0.0:
        for _ in range(parts):
            u, v = speed - spin * y, spin * x
            size = np.maximum(np.hypot(u, v), 1e-12)
            force = friction * G * u / size
            torque = friction * G * (v * x - u * y) / size
            speed = max(speed - h * float(force.mean()), 0.0)
            spin = max(spin - h * float(torque.mean()) / radius**2, 0.0)
        covered += time_step * speed
    return covered


def turntable_rate(spin: float, inertia_ratio: float) -> float:
    """Angular velocity at which a rolling ball's velocity turns on a turntable, rad/s: 2/7 of the table's.

    w k / (1 + k), k = I / (m r2) (Weltner, Am. J. Phys. 47, 984, 1979); the ball's path is a circle.
    """
    return spin * inertia_ratio / (1.0 + inertia_ratio)


def ladder_slope(friction: float) -> float:
    """Over the floor, below which a uniform ladder slips: atan((1 - mu2) / (2 mu)), radians.

    The same friction at floor and wall (any textbook of statics).

    Example:
        >>> round(math.degrees(ladder_slope(0.5)), 2)
        36.87
    """
    return math.atan2(1.0 - friction**2, 2.0 * friction)


def lifting_wedge_acceleration(slope: float, force: float, wedge: float, load: float) -> float:
    """Of a wedge pushed under a load that can only rise, without friction, m/s2.

    (F - m g tan a) / (M + m tan2 a): the load rises tan a times as fast.
    """
    rise = math.tan(slope)
    return (force - load * G * rise) / (wedge + load * rise**2)


def rocking_period(radius: float, depth: float, gyration: float, amplitude: float) -> float:
    """Of a body with a round belly that rocks without sliding, seconds.

    From the energy: 4 times the integral of dt over a quarter, by the midpoint rule. Small amplitudes:
    2 pi sqrt((k2 + (r - d)2) / (g d)).

    Args:
        radius: r, of the belly, meters.
        depth: d, of the center of mass below the belly's center, meters.
        gyration: k2, moment of inertia about the center of mass over the mass, m2.
        amplitude: Radians.

    Example:
        >>> small = 2.0 * math.pi * math.sqrt((0.01 + 0.06**2) / (G * 0.04))
        >>> round(rocking_period(0.1, 0.04, 0.01, 1e-4) / small, 6)
        1.0
    """
    phase = (np.arange(2000) + 0.5) * (0.5 * np.pi / 2000)
    angle = amplitude * np.sin(phase)
    inertia = gyration + radius**2 + depth**2 - 2.0 * radius * depth * np.cos(angle)
    fall = 2.0 * np.sin(0.5 * (amplitude + angle)) * np.sin(0.5 * (amplitude - angle))
    slowness = np.sqrt(inertia / (2.0 * G * depth * fall)) * amplitude * np.cos(phase)
    return float(4.0 * slowness.sum() * (0.5 * np.pi / 2000))


def key_play(side: float, hole: float) -> float:
    """How far a square key can turn in a square hole, radians: s (cos t + sin t) = hole.

    Example:
        >>> round(math.degrees(key_play(10.0, 10.4)), 2)
        2.34
    """
    return math.asin(hole / (math.sqrt(2.0) * side)) - 0.25 * math.pi
