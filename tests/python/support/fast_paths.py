"""Every query at many poses of a pair, against the flat loop over all points: the same bits."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import parts
import voxshell as vx
from parts import random_rotation
from voxshell.query.pairs import Collidable

MUCH = 2**40  # nodes of a budget that is never used up
FAR_AWAY = 100.0  # meters, or as many reaches of larger bodies: all points are within
EVERY = 20  # one in so many poses also asks for the nearest point, however far


@dataclass(frozen=True)
class Setting:
    """How one pose is asked about."""

    shell: str
    margin: float  # voxels
    level: int
    max_points: int


SETTINGS = (
    Setting("a", 0.0, 1, 7),
    Setting("auto", 0.0, 4, 1),
    Setting("fewest", 0.0, 4, 1),
    Setting("b", 0.0, 2, 30),
    Setting("both", 0.0, 3, 12),
    Setting("a", 0.25, 5, 2),
    Setting("auto", 1.5, 3, 100),
    Setting("fewest", 1.5, 3, 100),
    Setting("b", -0.5, 12, 4),
    Setting("both", 0.25, 6, 500),
)


@dataclass
class Pair:
    a: vx.Model
    b: Collidable
    fit: parts.Fit | None = None

    @property
    def shells(self) -> dict[str, vx.PointShell]:
        """Those there are, by body."""
        return {"a": self.a.shell} | ({"b": self.b.shell} if isinstance(self.b, vx.Model) else {})

    @property
    def reach(self) -> float:
        """Meters from the origin of either body to its farthest corner."""
        bodies = [self.a, self.b] if isinstance(self.b, vx.Model) else [self.a]
        return max(float(np.linalg.norm(np.abs(body.bounds).max(axis=0))) for body in bodies)


# ---- poses ---------------------------------------------------------------------------------------


def far_touching_or_deep(pair: Pair, count: int, rng: np.random.Generator) -> np.ndarray:
    """b_from_a, (count, 4, 4): far, touching and deep by turns.

    `a` comes from far along a direction to where it first touches `b`, and is moved on from there.
    """
    voxel = pair.a.field.voxel_size
    poses = np.tile(np.eye(4), (count, 1, 1))
    outwards = rng.normal(size=(count, 3))
    if isinstance(pair.b, vx.Plane):
        outwards[:] = pair.b.normal
    outwards /= np.linalg.norm(outwards, axis=1)[:, None]
    start = rng.uniform(-0.2 * pair.reach, 0.2 * pair.reach, (count, 3))
    for pose in poses:
        pose[:3, :3] = random_rotation(rng)
    near, far = np.zeros(count), np.full(count, 3.0 * pair.reach)
    for _ in range(14):
        middle = 0.5 * (near + far)
        poses[:, :3, 3] = start + middle[:, None] * outwards
        touches = vx.collide_batch(pair.a, pair.b, poses)
        near, far = np.where(touches, middle, near), np.where(touches, far, middle)
    gaps = np.stack(
        [
            rng.uniform(2.0 * voxel, pair.reach, count),
            rng.uniform(-1.0, 0.25, count) * voxel,
            rng.uniform(-0.4 * pair.reach, -2.0 * voxel, count),
        ]
    )[np.arange(count) % 3, np.arange(count)]
    poses[:, :3, 3] = start + (far + gaps)[:, None] * outwards
    if pair.fit:
        for i in np.flatnonzero((np.arange(count) % 3 > 0) & (np.arange(count) // 3 % 2 > 0)):
            poses[i] = pair.fit(rng)
            jitter = (0.2, 1.0, 4.0)[i // 6 % 3] * voxel
            poses[i, :3, 3] += rng.uniform(-jitter, jitter, 3)
    return poses


def nearby(pose: np.ndarray, step: float, rng: np.random.Generator) -> np.ndarray:
    """The same, moved and turned a little: what a scratch has seen last."""
    moved = pose.copy()
    turn = np.linalg.qr(np.eye(3) + 1e-3 * rng.normal(size=(3, 3)))[0]
    turn *= np.sign(np.diag(turn))
    moved[:3, :3] = turn @ moved[:3, :3]
    moved[:3, 3] += rng.uniform(-step, step, 3)
    return moved


# ---- what the flat loop's answer implies ---------------------------------------------------------

WITHOUT_SEGMENTS = ("points_a", "points_b", "normals", "depths", "ids", "shells")
ALL = (*WITHOUT_SEGMENTS, "segments")


def bits(
    contacts: vx.Contacts, names: tuple[str, ...] = ALL, rows: np.ndarray | None = None
) -> list[bytes]:
    """What there is of contacts, or of some of them."""
    arrays = [getattr(contacts, name) for name in names]
    return [array.tobytes() if rows is None else array[rows].tobytes() for array in arrays]


def deepest_rows(contacts: vx.Contacts, count: int) -> np.ndarray:
    """The `count` deepest, of equally deep ones the first; in their order."""
    return np.sort(np.argsort(-contacts.depths, kind="stable")[:count])


def deepest_of_segments(contacts: vx.Contacts, segments: np.ndarray) -> np.ndarray:
    """Rows of the deepest contact of each segment; `segments` are those of the contacts."""
    order = np.lexsort((np.arange(len(segments)), -contacts.depths, segments))
    ordered = segments[order]
    is_first = np.ones(len(order), dtype=bool)
    is_first[1:] = ordered[1:] != ordered[:-1]
    return np.sort(order[is_first])


# ---- the queries ---------------------------------------------------------------------------------


class Asker:
    """Asks about the poses of a pair and keeps its scratches from one to the next."""

    def __init__(self, pair: Pair, rng: np.random.Generator) -> None:
        self.pair = pair
        self.rng = rng
        self.scratches = [vx.QueryScratch() for _ in range(2)]

    def compare(self, index: int, setting: Setting, poses: tuple[np.ndarray, np.ndarray]) -> int:
        """Every query at one pose; returns the number of contacts."""
        pair, (followed, random) = self.pair, self.scratches
        bodies = (pair.a, pair.b)
        margin = setting.margin * pair.a.field.voxel_size
        options = {"shell": setting.shell, "margin": margin}
        flat = vx.testing.contacts_flat(*bodies, *poses, **options, level=setting.level)
        expected = bits(flat)

        def contacts(**more: object) -> vx.Contacts:
            return vx.contacts(*bodies, *poses, **options, level=setting.level, **more)

        assert bits(contacts()) == expected
        unbounded = contacts(budget=MUCH)
        assert unbounded.exact
        assert bits(unbounded) == expected
        few = deepest_rows(flat, setting.max_points)
        assert bits(contacts(max_points=setting.max_points)) == bits(flat, rows=few)
        step = 0.3 * pair.a.field.voxel_size
        vx.contacts(
            *bodies, nearby(poses[0], step, self.rng), poses[1], **options, scratch=followed
        )
        assert bits(contacts(scratch=followed)) == expected
        assert bits(contacts(scratch=followed)) == expected
        assert vx.collide(*bodies, *poses, **options) == (len(flat) > 0)
        self._compare_manifolds(index, setting, poses, flat, random)
        self._compare_distance(flat, poses, margin, random)
        if index % EVERY == 0:
            everything = {"shell": "a", "margin": FAR_AWAY * max(1.0, pair.reach)}
            all_points = vx.testing.contacts_flat(*bodies, *poses, **everything)
            assert set(range(len(pair.a.shell))) <= set(all_points.ids.tolist())
            self._compare_distance(all_points, poses, np.inf, random)
        return len(flat)

    def _compare_manifolds(
        self,
        index: int,
        setting: Setting,
        poses: tuple[np.ndarray, np.ndarray],
        flat: vx.Contacts,
        scratch: vx.QueryScratch,
    ) -> None:
        if flat.shell == "both":  # each of its shells has its own manifolds
            return
        pair, margin = self.pair, setting.margin * self.pair.a.field.voxel_size
        arguments = (pair.a, pair.b, *poses)
        options = {"shell": setting.shell, "margin": margin, "scratch": scratch}
        size = 1 + index % 4
        # The level, by which segments are told apart, is not the same here.
        for most in (4, size):
            found = vx.manifold(*arguments, **options, max_points=most)
            assert bits(found, WITHOUT_SEGMENTS) == bits(flat.manifold(most), WITHOUT_SEGMENTS)
        for level in (setting.level, 1 + index % 12):
            found = vx.deepest_per_segment(*arguments, **options, level=level)
            segments = flat.segments
            if level != setting.level:
                own = {"shell": setting.shell, "margin": margin, "level": level}
                segments = vx.testing.contacts_flat(*arguments, **own).segments
            rows = deepest_of_segments(flat, segments)
            assert found.segments.tolist() == segments[rows].tolist()
            assert bits(found, WITHOUT_SEGMENTS) == bits(flat, WITHOUT_SEGMENTS, rows)

    def _compare_distance(
        self,
        flat: vx.Contacts,
        poses: tuple[np.ndarray, np.ndarray],
        below: float,
        scratch: vx.QueryScratch,
    ) -> None:
        nearest = vx.distance(
            self.pair.a,
            self.pair.b,
            *poses,
            shell=flat.shell,
            max_distance=below,
            scratch=scratch,
        )
        if len(flat) == 0:
            assert nearest.distance == np.inf
            return
        row = int(np.argmax(flat.depths))
        assert nearest.distance == -flat.depths[row]
        assert nearest.shell == flat.shells[row]
        assert nearest.point_a.tobytes() == flat.points_a[row].tobytes()
        assert nearest.point_b.tobytes() == flat.points_b[row].tobytes()
        assert nearest.normal.tobytes() == flat.normals[row].tobytes()


# ---- many poses ----------------------------------------------------------------------------------


def compare_all(
    asker: Asker, start: int, b_from_a: np.ndarray, rng: np.random.Generator
) -> tuple[np.ndarray, int]:
    """Every query at some poses of a pair, the first of which has the number `start`.

    Returns:
        Whether each pose is in contact, (n,) bool, and the number of contacts.
    """
    pair = asker.pair
    in_contact = np.zeros(len(b_from_a), dtype=bool)
    contacts = 0
    world_from_b = np.tile(np.eye(4), (len(b_from_a), 1, 1))
    for pose in world_from_b:
        pose[:3, :3] = random_rotation(rng)
        pose[:3, 3] = rng.uniform(-2.0, 2.0, 3)
    world_from_a = world_from_b @ b_from_a
    for s, setting in enumerate(SETTINGS):
        if setting.shell not in {"auto", "fewest", *pair.shells}:
            setting = Setting("a", setting.margin, setting.level, setting.max_points)
        rows = np.arange(s, len(b_from_a), len(SETTINGS))
        poses = (world_from_a[rows], world_from_b[rows])
        margin = setting.margin * pair.a.field.voxel_size
        options = {"shell": setting.shell, "margin": margin}
        batch = vx.contacts_batch(pair.a, pair.b, *poses, **options, level=setting.level)
        touches = vx.collide_batch(pair.a, pair.b, *poses, **options)
        for i, row in enumerate(rows.tolist()):
            found = asker.compare(start + row, setting, (poses[0][i], poses[1][i]))
            one = vx.contacts(
                pair.a, pair.b, poses[0][i], poses[1][i], **options, level=setting.level
            )
            assert bits(batch[i]) == bits(one)
            assert touches[i] == (found > 0)
            in_contact[row] = found > 0
            contacts += found
    return in_contact, contacts
