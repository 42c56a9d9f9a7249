"""Pictures of bodies under a sky and a sun, drawn with numpy alone: soft shadows, a ground with a grid, marks on top.

All lengths are in meters, in the world frame with z up.
"""

from typing import NamedTuple

import numpy as np

SUN = np.array([-0.50, -0.42, 0.76])  # direction toward the sun
SUN_SIZE, SUN_MAP, SKY_MAP = (
    0.055,
    512,
    192,
)  # angular radius in radians; texels along a side of each shadow map
DOTS_A_TEXEL = 1.3  # dots per texel that cast shadows; holes of one texel are filled
SUN_LIGHT, SKY_LIGHT, BOUNCE = np.array([1.70, 1.62, 1.50]), np.array([1.0, 1.06, 1.16]), 0.45
SKY_TOP, SKY_FOOT = np.array([226, 233, 242]), np.array([250, 251, 253])  # of the background
GROUND, LINE = np.array([218, 223, 230]), np.array([150, 160, 173])
CREASE = np.cos(np.radians(38.0))


class Surface(NamedTuple):
    """The surface of a body, in the body's frame.

    Args:
        corners: (m, 3, 3), corners of the triangles.
        normals: (m, 3, 3), normals at the corners; those of neighbors agree, except at creases.
        dots: (k, 3), points on the whole surface, which cast the shadows; the first n of them are evenly
            distributed for any n.
        area: Area of the surface.
        color: (3,), 0 to 255.
    """

    corners: np.ndarray
    normals: np.ndarray
    dots: np.ndarray
    area: float
    color: tuple


class Camera(NamedTuple):
    """A camera: ``axes`` has the rows right, up and back; ``tangent`` is that of half the vertical angle of view."""

    position: np.ndarray
    axes: np.ndarray
    tangent: float


def make_surface(vertices, faces, color, *, dots=300_000):
    """Return the surface of a mesh with (n, 3) vertices and (m, 3) faces."""
    corners = np.asarray(vertices, float)[np.asarray(faces, np.int64)]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    total = np.cumsum(0.5 * np.linalg.norm(normals, axis=1))
    # The first n multiples of these irrational numbers fill a cube evenly, for any n.
    fractions = (np.arange(1, dots + 1)[:, None] * (0.8191725134, 0.6710436067, 0.5497004779)) % 1.0
    chosen = np.searchsorted(total, fractions[:, 0] * total[-1]).clip(max=len(corners) - 1)
    first, second = np.sqrt(fractions[:, 1:2]), fractions[:, 2:]
    a, b, c = np.moveaxis(corners[chosen].astype(np.float32), 1, 0)
    spread = (1.0 - first) * a + first * (1.0 - second) * b + first * second * c
    area = float(total[-1])
    return Surface(corners, _smooth(corners, normals), spread.astype(np.float32), area, color)


def place_camera(points, size, *, azimuth=25.0, elevation=20.0, fill=0.84, angle=24.0):
    """Return a camera whose picture (n, 3) points fill; azimuth 0 looks along y. ``angle`` is vertical; degrees."""
    turn, tilt = np.radians([azimuth, elevation])
    back = np.array([np.sin(turn) * np.cos(tilt), -np.cos(turn) * np.cos(tilt), np.sin(tilt)])
    right = np.array([np.cos(turn), np.sin(turn), 0.0])
    axes = np.stack([right, np.cross(back, right), back])
    tangent = np.tan(np.radians(0.5 * angle))
    wide = np.array([size[0] / size[1], 1.0]) * tangent
    target = 0.5 * (points.min(axis=0) + points.max(axis=0))
    distance = 3.0 * np.linalg.norm(points - target, axis=1).max() / tangent
    for _ in range(30):  # each round is exact but for perspective
        seen = (points - target - distance * back) @ axes.T
        flat = seen[:, :2] / -seen[:, 2:] / wide
        middle = 0.5 * (flat.min(axis=0) + flat.max(axis=0))
        target = target + distance * (middle * wide) @ axes[:2]
        distance *= 1.0 + 0.7 * (np.ptp(flat, axis=0).max() / 2.0 / fill - 1.0)
    return Camera(target + distance * back, axes, tangent)


def render(bodies, camera, size, *, ground=None, cell=None, marks=(), finer=2, suns=16, skies=48):
    """Draw a picture.

    Args:
        bodies: Pairs of a surface and a pose (4, 4).
        camera: The camera.
        size: Width and height, pixels.
        ground: Height of the ground; None for no ground.
        cell: Distance of the lines on it; None for no lines.
        marks: Pairs like bodies, drawn on top of all bodies and without shadows.
        finer: Number of samples along each side of a pixel.
        suns: Number of samples of the sun's disk.
        skies: Number of samples of the sky.

    Returns:
        (h, w, 3) uint8.
    """
    width, height = size[0] * finer, size[1] * finer
    background = _paint_background(width, height)
    place, normal, color, body = _find_seen(bodies, camera, (width, height), ground)
    if ground is not None and cell is not None:
        _paint_grid(place, color, body, camera, ground, cell, height)
    seen = np.flatnonzero(body > -2)
    light, sun = _light(bodies, ground, place, normal, body, seen, (width, height), suns, skies)
    picture = background.copy()
    shaded = _shade(place[seen], normal[seen], color[seen], light, sun, camera, body[seen] < 0)
    if ground is not None:
        center, radius = _find_sphere(bodies)
        away = np.linalg.norm(place[seen][:, :2] - center[:2], axis=1) / radius
        haze = np.clip((away - 1.4) / 2.6, 0.0, 1.0)[:, None] * (body[seen] < 0)[:, None]
        haze = haze * haze * (3.0 - 2.0 * haze)
        shaded = shaded * (1.0 - haze) + background[seen] * haze
    picture[seen] = shaded
    if marks:
        _paint_marks(picture, place, body, marks, camera, (width, height))
    picture = picture.reshape(size[1], finer, size[0], finer, 3).mean(axis=(1, 3))
    return (255.0 * _to_srgb(np.clip(picture, 0.0, 1.0)) + 0.5).astype(np.uint8)


def to_light(color):
    """Return the amounts of light, 0 to 1, of an sRGB color, 0 to 255."""
    fraction = np.asarray(color, float) / 255.0
    return np.where(fraction <= 0.04045, fraction / 12.92, ((fraction + 0.055) / 1.055) ** 2.4)


def _to_srgb(light):
    return np.where(light <= 0.0031308, 12.92 * light, 1.055 * light ** (1 / 2.4) - 0.055)


def _smooth(corners, normals):
    """Return normals at corners: means over the faces around the same point, up to creases."""
    unit = normals / np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-300)
    grain = 1e-7 * np.ptp(corners.reshape(-1, 3), axis=0).max()
    keys = np.round(corners.reshape(-1, 3) / max(grain, 1e-300)).astype(np.int64)
    _, point = np.unique(keys @ (73856093, 19349663, 83492791), return_inverse=True)
    order = np.argsort(point.ravel(), kind="stable")
    point, face = point.ravel()[order], order // 3
    total = normals[face].copy()
    for shift in range(1, min(int(np.bincount(point).max()), 200)):
        one, other = slice(None, -shift), slice(shift, None)
        near = point[one] == point[other]
        near &= np.einsum("ij,ij->i", unit[face[one]], unit[face[other]]) > CREASE
        first, second = np.flatnonzero(near), np.flatnonzero(near) + shift
        total[first] += normals[face[second]]
        total[second] += normals[face[first]]
    total /= np.maximum(np.linalg.norm(total, axis=1, keepdims=True), 1e-300)
    result = np.empty_like(total)
    result[order] = total
    return result.reshape(-1, 3, 3)


def _paint_background(width, height):
    fraction = np.clip(np.linspace(0.0, 1.45, height), 0.0, 1.0)[:, None]
    column = to_light(SKY_TOP) * (1.0 - fraction) + to_light(SKY_FOOT) * fraction
    return np.repeat(column, width, axis=0)


def _find_sphere(bodies):
    """Return the center and the radius of a sphere around all bodies."""
    ends = []
    for surface, pose in bodies:
        points = surface.dots[:4000] @ pose[:3, :3].T + pose[:3, 3]
        ends += [points.min(axis=0), points.max(axis=0)]
    low, high = np.min(ends, axis=0), np.max(ends, axis=0)
    return 0.5 * (low + high), 0.53 * float(np.linalg.norm(high - low))


def _place(pairs):
    """Return all triangles in the world frame: corners and normals (m, 3, 3), and numbers of their pairs (m,)."""
    corners = [surface.corners @ pose[:3, :3].T + pose[:3, 3] for surface, pose in pairs]
    normals = [surface.normals @ pose[:3, :3].T for surface, pose in pairs]
    owner = np.repeat(np.arange(len(pairs)), [len(one) for one in corners])
    return np.concatenate(corners), np.concatenate(normals), owner


def _project(corners, camera, size):
    """Return (m, 3, 3): pixels right and down, and the inverse of the distance along the view."""
    seen = (corners - camera.position) @ camera.axes.T
    near = 1.0 / np.maximum(-seen[..., 2], 1e-9)
    scale = 0.5 * size[1] / camera.tangent
    across = 0.5 * size[0] + scale * seen[..., 0] * near
    return np.stack([across, 0.5 * size[1] - scale * seen[..., 1] * near, near], axis=-1)


def _rasterize(triangles, size):
    """Return the nearest triangle of each pixel, (h * w,), or -1, of corners (m, 3, 3) from ``_project``."""
    width, height = size
    best = np.full(width * height, -1, np.int64)
    top = triangles[..., 2].max()
    low = np.floor(triangles[..., :2].min(axis=1)).astype(np.int64).clip(0)
    high = np.ceil(triangles[..., :2].max(axis=1)).astype(np.int64).clip(max=(width, height))
    span = (high - low).max(axis=1)
    span[(high <= low).any(axis=1)] = 0
    edge = triangles[:, 1:, :2] - triangles[:, :1, :2]
    area = edge[:, 0, 0] * edge[:, 1, 1] - edge[:, 0, 1] * edge[:, 1, 0]
    span[np.abs(area) < 1e-12] = 0
    side = 1
    while side // 2 < span.max(initial=0):
        chosen = np.flatnonzero((span > side // 2) & (span <= side))
        step = max(1, 100_000 // side**2)  # fits into caches
        grid = np.indices((side, side)).reshape(2, -1)
        for begin in range(0, len(chosen), step):
            part = chosen[begin : begin + step]
            x, y = low[part, :1] + grid[1], low[part, 1:] + grid[0]
            right = x + 0.5 - triangles[part, 0, 0][:, None]
            down = y + 0.5 - triangles[part, 0, 1][:, None]
            one, two, inverse = edge[part, 0], edge[part, 1], 1.0 / area[part][:, None]
            second = (right * two[:, 1:] - down * two[:, :1]) * inverse
            third = (down * one[:, :1] - right * one[:, 1:]) * inverse
            inside = (second >= 0) & (third >= 0) & (second + third <= 1)
            inside &= (x < high[part, :1]) & (y < high[part, 1:])
            depth = triangles[part, :, 2]
            near = depth[:, :1] + second * (depth[:, 1:2] - depth[:, :1])
            near += third * (depth[:, 2:] - depth[:, :1])
            key = (near / top * (1 << 30)).astype(np.int64) << 32 | part[:, None]
            np.maximum.at(best, (y * width + x)[inside], key[inside])
        side *= 2
    return np.where(best < 0, -1, best & 0xFFFFFFFF)


def _interpolate(pixels, triangles, projected, size):
    """Return (k, 3) weights of the corners of the triangles in pixels, correct in perspective."""
    x, y = pixels % size[0] + 0.5, pixels // size[0] + 0.5
    flat = projected[triangles]
    edge = flat[:, 1:, :2] - flat[:, :1, :2]
    area = edge[:, 0, 0] * edge[:, 1, 1] - edge[:, 0, 1] * edge[:, 1, 0]
    right, down = x - flat[:, 0, 0], y - flat[:, 0, 1]
    second = (right * edge[:, 1, 1] - down * edge[:, 1, 0]) / area
    third = (down * edge[:, 0, 0] - right * edge[:, 0, 1]) / area
    weights = np.stack([1.0 - second - third, second, third], axis=1) * flat[..., 2]
    return weights / weights.sum(axis=1, keepdims=True)


def _find_seen(bodies, camera, size, ground):
    """Return for each pixel: place, normal, color (light), and number of the body, -1 the ground, -2 nothing."""
    count = size[0] * size[1]
    place, normal, color = np.zeros((3, count, 3))
    body = np.full(count, -2)
    depth = np.zeros(count)
    if ground is not None:
        x = ((np.arange(size[0]) + 0.5) - 0.5 * size[0]) * 2.0 * camera.tangent / size[1]
        y = (0.5 * size[1] - (np.arange(size[1]) + 0.5)) * 2.0 * camera.tangent / size[1]
        ray = np.stack([*np.meshgrid(x, y), np.full((size[1], size[0]), -1.0)], axis=-1)
        ray = ray.reshape(-1, 3) @ camera.axes
        down = ray[:, 2] < -1e-6
        far = (ground - camera.position[2]) / np.where(down, ray[:, 2], -1.0)
        down &= far > 0.0
        place[down] = camera.position + far[down, None] * ray[down]
        normal[down], color[down] = (0.0, 0.0, 1.0), to_light(GROUND)
        body[down], depth[down] = -1, 1.0 / far[down]
    corners, normals, owner = _place(bodies)
    projected = _project(corners, camera, size)
    best = _rasterize(projected, size)
    pixels = np.flatnonzero(best >= 0)
    weights = _interpolate(pixels, best[pixels], projected, size)
    near = 1.0 / ((weights / projected[best[pixels]][..., 2]).sum(axis=1))
    front = near >= depth[pixels]
    pixels, weights = pixels[front], weights[front]
    triangles = best[pixels]
    place[pixels] = np.einsum("nc,ncx->nx", weights, corners[triangles])
    turned = np.einsum("nc,ncx->nx", weights, normals[triangles])
    turned /= np.maximum(np.linalg.norm(turned, axis=1, keepdims=True), 1e-300)
    toward = camera.position - place[pixels]
    flip = np.einsum("ij,ij->i", turned, toward) < -0.15 * np.linalg.norm(toward, axis=1)
    normal[pixels] = np.where(flip[:, None], -turned, turned)
    body[pixels] = owner[triangles]
    colors = to_light([surface.color for surface, _ in bodies])
    color[pixels] = colors[body[pixels]]
    return place, normal, color, body


def _paint_grid(place, color, body, camera, ground, cell, height):
    """Paint lines on the ground, one pixel wide: every fifth is stronger, and far ones are fainter."""
    on = np.flatnonzero(body == -1)
    away = np.linalg.norm(place[on] - camera.position, axis=1)
    slope = np.maximum((camera.position[2] - ground) / away, 0.05)
    pixel = 2.0 * camera.tangent * away / height
    for space, strength in ((cell, 0.45), (5.0 * cell, 0.55)):
        cover = np.zeros(len(on))
        for axis in (0, 1):
            along = np.abs(camera.axes[2, axis]) / max(np.hypot(*camera.axes[2, :2]), 1e-9)
            wide = pixel * (1.0 + (1.0 / slope - 1.0) * along)
            off = np.abs(place[on, axis] / space - np.round(place[on, axis] / space)) * space
            line = np.clip(1.5 - off / (0.9 * wide), 0.0, 1.0)
            cover = np.maximum(cover, line * np.clip(1.4 - 5.0 * wide / space, 0.0, 1.0))
        color[on] += (strength * cover)[:, None] * (to_light(LINE) - color[on])


def _aim(direction):
    """Return as rows two unit vectors perpendicular to a direction, and the direction."""
    helper = np.eye(3)[np.argmin(np.abs(direction))]
    first = np.cross(direction, helper)
    first /= np.linalg.norm(first)
    return np.stack([first, np.cross(direction, first), direction]).astype(np.float32)


def _spread(bodies, center, texel):
    """Return (k, 3) float32: dots of all bodies, relative to a point, dense enough for shadow maps."""
    places = []
    for surface, pose in bodies:
        dots = surface.dots[: int(DOTS_A_TEXEL * surface.area / texel**2) + 1000]
        places.append(dots @ pose[:3, :3].T.astype(np.float32) + (pose[:3, 3] - center))
    return np.concatenate(places).astype(np.float32)


def _cast(dots, places, radius, direction, side):
    """Return (n,): the fraction of light from a direction that passes the dots (k, 3) to places (n, 3)."""
    axes = _aim(direction).T * np.float32(0.5 * side / radius)
    middle = np.float32(0.5 * side)
    flat = dots @ axes
    across = (flat[:, :2] + middle).astype(np.int32)
    nearest = np.full(side * side, -1e9, np.float32)
    np.maximum.at(nearest, across[:, 0] * side + across[:, 1], flat[:, 2])
    nearest = _close(nearest.reshape(side, side)).ravel()
    flat = places @ axes
    flat[:, :2] += middle - np.float32(0.5)
    np.clip(flat[:, :2], 0.0, np.float32(side - 1.001), out=flat[:, :2])  # the rim is empty
    whole = flat[:, :2].astype(np.int32)
    right, up = (flat[:, :2] - whole).T
    index = whole[:, 0] * side + whole[:, 1]
    height = flat[:, 2] + np.float32(1.2)
    near, far = (
        (1.0 - up) * (nearest[i] <= height) + up * (nearest[i + 1] <= height)
        for i in (index, index + side)
    )
    return (1.0 - right) * near + right * far


def _close(heights):
    """Fill holes of one texel: a minimum over squares of three texels, after a maximum."""
    for extreme in (np.maximum, np.minimum):
        for axis in (0, 1):
            around = extreme(np.roll(heights, 1, axis), np.roll(heights, -1, axis))
            heights = extreme(heights, around)
    return heights


def _light(bodies, ground, place, normal, body, seen, size, suns, skies):
    """Return the light from the sky (k, 3) and the visible fraction of the sun (k,) for the pixels seen.

    One sample is lit for all of four similar samples of a pixel. On the ground it is one for sixteen, smoothed over
    neighbors, because each sample of the light casts a shadow with a sharp edge.
    """
    center, radius = _find_sphere(bodies)
    row, column = seen // size[0], seen % size[0]
    side = np.where(body[seen] < 0, 4, 2)
    block = (row // side) * (size[0] // 2 + 1) + column // side
    facing = np.round(normal[seen] * 3.0).astype(np.int64) + 4
    key = (block * 1000 + facing @ (81, 9, 1)) * (len(bodies) + 3) + body[seen] + 2
    _, first, group = np.unique(key, return_index=True, return_inverse=True)
    chosen = seen[first]
    axis = normal[chosen].astype(np.float32)
    origin = (place[chosen] - center).astype(np.float32)
    fine, coarse = (_spread(bodies, center, 2.0 * radius / side) for side in (SUN_MAP, SKY_MAP))
    sky = np.zeros((len(chosen), 3), np.float32)
    turn = np.pi * (3.0 - 5.0**0.5)
    lifted = origin + axis * np.float32(1.6 * 2.0 * radius / SKY_MAP)
    for number in range(skies):  # evenly on the upper half of a sphere
        up = (number + 0.5) / skies
        ring = np.sqrt(1.0 - up * up)
        direction = np.array([ring * np.cos(turn * number), ring * np.sin(turn * number), up])
        facing = axis @ direction.astype(np.float32)
        near = np.flatnonzero(facing > 0.0)
        free = _cast(coarse, lifted[near], radius, direction, SKY_MAP)
        amount = (2.0 / skies) * (0.7 + 0.3 * up) / 0.85
        sky[near] += (amount * free * facing[near])[:, None] * SKY_LIGHT.astype(np.float32)
    above = np.ones(len(chosen))
    if ground is not None:
        above = 0.25 + 0.75 * np.clip((place[chosen, 2] - ground) / (0.5 * radius), 0.0, 1.0)
    below = BOUNCE * (0.5 - 0.5 * axis[:, 2]) * above
    sky += below[:, None].astype(np.float32)
    sun = np.zeros(len(chosen), np.float32)
    lifted = origin + axis * np.float32(1.6 * 2.0 * radius / SUN_MAP)
    middle = SUN / np.linalg.norm(SUN)
    lit = np.flatnonzero(axis @ middle.astype(np.float32) > -0.05)
    around = _aim(middle)
    for number in range(suns):
        away, angle = SUN_SIZE * np.sqrt((number + 0.5) / suns), turn * number
        direction = middle + away * (np.cos(angle) * around[0] + np.sin(angle) * around[1])
        direction /= np.linalg.norm(direction)
        sun[lit] += _cast(fine, lifted[lit], radius, direction, SUN_MAP) / suns
    light = np.column_stack([sky, sun])
    on, lit = body[seen] == -1, body[chosen] == -1
    result = light[group.ravel()]
    if on.any():
        places = np.stack([row, column], axis=1)
        result[on] = _smooth_over(places[first[lit]] // 4, light[lit], (places[on] + 0.5) / 4.0)
    return result[:, :3], result[:, 3]


def _smooth_over(cells, values, places, *, radius=2):
    """Return values (n, 4) at places (n, 2) of a grid, smoothed, from those (k, 4) of some of its cells (k, 2)."""
    shape = np.maximum(cells.max(axis=0), np.ceil(places.max(axis=0)).astype(int)) + 2 * radius + 2
    sums = np.zeros((*shape, 5), np.float32)
    sums[cells[:, 0], cells[:, 1], :4] = values
    sums[cells[:, 0], cells[:, 1], 4] = 1.0
    for axis in (0, 1, 0, 1):
        sums = sum(np.roll(sums, shift, axis) for shift in range(-radius, radius + 1))
    low = np.floor(places - 0.5).astype(np.int64)  # -1 is the empty rim at the other side
    down, right = (places - 0.5 - low).astype(np.float32).T
    found = np.zeros((len(places), 5), np.float32)
    for i, across in ((0, 1.0 - down), (1, down)):
        for j, along in ((0, 1.0 - right), (1, right)):
            found += (across * along)[:, None] * sums[low[:, 0] + i, low[:, 1] + j]
    return found[:, :4] / found[:, 4:]


def _shade(place, normal, color, light, sun, camera, is_ground):
    """Return the light (k, 3) that places send to the camera."""
    middle = SUN / np.linalg.norm(SUN)
    toward = camera.position - place
    toward /= np.linalg.norm(toward, axis=1, keepdims=True)
    facing = np.maximum(normal @ middle, 0.0)
    half = middle + toward
    half /= np.linalg.norm(half, axis=1, keepdims=True)
    sheen = 0.22 * np.maximum(np.einsum("ij,ij->i", normal, half), 0.0) ** 48 * sun * (facing > 0)
    rim = np.clip(1.0 - np.einsum("ij,ij->i", normal, toward), 0.0, 1.0) ** 4
    gloss = np.where(is_ground, 0.0, 1.0)
    total = light + (sun * facing)[:, None] * SUN_LIGHT
    shaded = 0.52 * color * total
    shaded += (gloss * sheen)[:, None]
    shaded += (gloss * 0.22 * rim)[:, None] * light
    over = np.maximum(shaded - 0.7, 0.0)  # the brightest parts level off
    return np.minimum(shaded, 0.7) + 0.3 * (1.0 - np.exp(-over / 0.3))


def _paint_marks(picture, place, body, marks, camera, size):
    """Draw marks over the picture: strong where they are in front, faint behind bodies."""
    corners, normals, owner = _place(marks)
    projected = _project(corners, camera, size)
    best = _rasterize(projected, size)
    pixels = np.flatnonzero(best >= 0)
    triangles = best[pixels]
    weights = _interpolate(pixels, triangles, projected, size)
    turned = np.einsum("nc,ncx->nx", weights, normals[triangles])
    turned /= np.maximum(np.linalg.norm(turned, axis=1, keepdims=True), 1e-300)
    where = np.einsum("nc,ncx->nx", weights, corners[triangles])
    colors = to_light([surface.color for surface, _ in marks])[owner[triangles]]
    facing = turned @ camera.axes[2]
    shaded = colors * (0.55 + 0.5 * np.clip(facing, 0.0, 1.0))[:, None]
    shaded += 0.12 * np.clip(facing, 0.0, 1.0)[:, None] ** 20
    behind = (place[pixels] - camera.position) @ camera.axes[2] > (
        where - camera.position
    ) @ camera.axes[2]
    behind &= body[pixels] > -2
    strength = np.where(behind, 0.72, 1.0)[:, None]
    picture[pixels] = picture[pixels] * (1.0 - strength) + shaded * strength
