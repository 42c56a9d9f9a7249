"""Queries of two bodies in many poses at once, on all CPU cores."""

from __future__ import annotations

import operator
from typing import TYPE_CHECKING, NoReturn

import numpy as np

from voxshell import _core
from voxshell.base.arguments import as_threads, check_callable
from voxshell.base.calls import explain_calls
from voxshell.base.pose_forms import as_pose_arrays, mend_poses
from voxshell.errors import InputTypeError, PoseError
from voxshell.query.contact_set import Contacts, name_shells
from voxshell.query.pairs import (
    Collidable,
    Shell,
    as_level,
    as_margin,
    as_max_points,
    as_pair,
)

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from numpy.typing import ArrayLike, NDArray


class ContactBatch:
    """The contacts of two bodies in k poses; from :func:`voxshell.contacts_batch`.

    The arrays hold the :class:`Contacts` of all poses, one after another: pose ``i`` has the rows
    ``offsets[i]`` to ``offsets[i + 1]``. They are read-only, in the world frame, and stay valid
    without this object. ``len()`` is k; indexing and iterating return the :class:`Contacts` of each
    pose.

    Example:
        >>> import numpy as np
        >>> import trimesh
        >>> import voxshell as vx
        >>> ball = vx.Model.from_mesh(trimesh.creation.icosphere(radius=0.1), voxel_size=0.01)
        >>> world_from_ball = np.tile(np.eye(4), (3, 1, 1))
        >>> world_from_ball[:, 2, 3] = (0.2, 0.099, 0.09)
        >>> batch = vx.contacts_batch(ball, vx.Plane(), world_from_ball)
        >>> batch
        ContactBatch(3 poses, 2 in contact, 90 contacts)
        >>> batch.offsets.tolist()
        [0, 0, 5, 90]
        >>> batch[1]
        Contacts(5 of a's points, deepest 0.001 m)
    """

    __slots__ = ("_core",)

    def __init__(self, core: _core.ContactBatch) -> None:
        self._core = core

    def __reduce__(self) -> NoReturn:
        raise InputTypeError(
            "a ContactBatch cannot be pickled or copied: pass the arrays of its Contacts, such as "
            "contacts.points_b, contacts.normals and contacts.depths"
        )

    def __len__(self) -> int:
        return len(self._core)

    def __getitem__(self, index: int) -> Contacts:
        try:
            wanted = operator.index(index)
        except TypeError:
            raise InputTypeError(
                f"index must be an integer, not {type(index).__name__}; for ranges of poses, "
                f"slice the arrays by offsets"
            ) from None
        position = wanted + len(self) if wanted < 0 else wanted
        if not 0 <= position < len(self):
            raise IndexError(f"pose {wanted} of a batch of {len(self)}")
        return Contacts(self._core.at(position))

    def __iter__(self) -> Iterator[Contacts]:
        return (self[i] for i in range(len(self)))

    @property
    def offsets(self) -> NDArray[np.int64]:
        """First row of each pose's contacts, and the total number of rows, (k + 1,) int64."""
        return self._core.offsets

    @property
    def points_a(self) -> NDArray[np.float64]:
        """As :attr:`Contacts.points_a`."""
        return self._core.points_a

    @property
    def points_b(self) -> NDArray[np.float64]:
        """As :attr:`Contacts.points_b`."""
        return self._core.points_b

    @property
    def normals(self) -> NDArray[np.float64]:
        """As :attr:`Contacts.normals`."""
        return self._core.normals

    @property
    def depths(self) -> NDArray[np.float64]:
        """As :attr:`Contacts.depths`."""
        return self._core.depths

    @property
    def ids(self) -> NDArray[np.int64]:
        """As :attr:`Contacts.ids`."""
        return self._core.ids

    @property
    def segments(self) -> NDArray[np.int64]:
        """As :attr:`Contacts.segments`."""
        return self._core.segments

    @property
    def shells(self) -> NDArray[np.str_]:
        """As :attr:`Contacts.shells`."""
        return name_shells(self._core.shells)

    def __repr__(self) -> str:
        in_contact = np.count_nonzero(np.diff(self.offsets))
        return (
            f"ContactBatch({len(self)} poses, {in_contact} in contact, {len(self.depths)} contacts)"
        )


@explain_calls
def contacts_batch(
    a: Collidable,
    b: Collidable,
    a_poses: ArrayLike | None = None,
    b_poses: ArrayLike | None = None,
    *,
    shell: Shell = "auto",
    margin: float = 0.0,
    level: int | None = None,
    max_points: int | None = None,
    threads: int | None = None,
    progress: Callable[[str, float], object] | None = None,
) -> ContactBatch:
    """Find the contacts of two bodies in each of many poses, as :func:`contacts` does.

    Other Python threads continue to run. Ctrl-C stops the query.

    Args:
        a: A :class:`Model`, or an analytic shape such as :class:`Plane` or :class:`Capsule`.
        b: Likewise. At least one of the two must be a model.
        a_poses: ``world_from_a``: (k, 4, 4), (k, 3) or (k, 7) float64, or another form that
            :func:`pose` lists; a single pose applies to all. None: the identity.
        b_poses: ``world_from_b``, likewise.
        shell: As for :func:`contacts`.
        margin: As for :func:`contacts`.
        level: As for :func:`contacts`.
        max_points: As for :func:`contacts`, for each pose.
        threads: Number of threads, up to 1024; one per CPU core by default. It does not affect the
            result.
        progress: Called from this thread about every 50 ms with the name of the stage and its
            completed fraction, 0 to 1. If it raises, the query stops and raises the same exception.

    Returns:
        The contacts of all poses, in order, with the same bits that :func:`contacts` returns.

    Raises:
        PoseError: A pose is in no form that :func:`pose` lists, is not rigid, or is not finite. The
            message says which.
        SettingsError: As for :func:`contacts`; or the numbers of poses differ.
        InputTypeError: ``a`` or ``b`` is not a body.

    Example:
        >>> import numpy as np
        >>> import trimesh
        >>> import voxshell as vx
        >>> ball = vx.Model.from_mesh(trimesh.creation.icosphere(radius=0.1), voxel_size=0.01)
        >>> world_from_ball = np.tile(np.eye(4), (100, 1, 1))
        >>> world_from_ball[:, 2, 3] = np.linspace(0.2, 0.05, 100)
        >>> batch = vx.contacts_batch(ball, vx.Plane(), world_from_ball)
        >>> deepest = [float(contacts.depths.max(initial=0.0)) for contacts in batch]
        >>> round(max(deepest), 4)
        0.05
    """
    count, (of_a, of_b) = as_pose_arrays(a_poses=a_poses, b_poses=b_poses)
    bodies, shells = as_pair(a, b, shell)
    check_callable(progress, "progress")
    try:
        found = _core.contacts_batch(
            *bodies,
            count,
            of_a,
            of_b,
            shells,
            as_margin(margin),
            as_level(level),
            as_max_points(max_points),
            as_threads(threads),
            progress,
        )
    except PoseError as error:
        return contacts_batch(
            a,
            b,
            **mend_poses(error, a_poses=a_poses, b_poses=b_poses),
            shell=shell,
            margin=margin,
            level=level,
            max_points=max_points,
            threads=threads,
            progress=progress,
        )
    return ContactBatch(found)


@explain_calls
def collide_batch(
    a: Collidable,
    b: Collidable,
    a_poses: ArrayLike | None = None,
    b_poses: ArrayLike | None = None,
    *,
    shell: Shell = "auto",
    margin: float = 0.0,
    threads: int | None = None,
    progress: Callable[[str, float], object] | None = None,
) -> NDArray[np.bool_]:
    """Return in which of many poses two bodies touch, as :func:`collide` does.

    Args:
        a: A :class:`Model`, or an analytic shape such as :class:`Plane` or :class:`Capsule`.
        b: Likewise. At least one of the two must be a model.
        a_poses: As for :func:`contacts_batch`.
        b_poses: As for :func:`contacts_batch`.
        shell: As for :func:`contacts`.
        margin: Bodies that are nearer than this count as touching, meters.
        threads: Number of threads, up to 1024; one per CPU core by default. It does not affect the
            result.
        progress: As for :func:`contacts_batch`.

    Returns:
        (k,) bool.

    Raises:
        PoseError: A pose is in no form that :func:`pose` lists, is not rigid, or is not finite. The
            message says which.
        SettingsError: As for :func:`collide`; or the numbers of poses differ.
        InputTypeError: ``a`` or ``b`` is not a body.

    Example:
        >>> import numpy as np
        >>> import trimesh
        >>> import voxshell as vx
        >>> ball = vx.Model.from_mesh(trimesh.creation.icosphere(radius=0.1), voxel_size=0.01)
        >>> world_from_ball = np.tile(np.eye(4), (3, 1, 1))
        >>> world_from_ball[:, 2, 3] = (0.2, 0.099, 0.09)
        >>> vx.collide_batch(ball, vx.Plane(), world_from_ball)
        array([False,  True,  True])
    """
    bodies, shells = as_pair(a, b, shell)
    check_callable(progress, "progress")
    count, (of_a, of_b) = as_pose_arrays(a_poses=a_poses, b_poses=b_poses)
    try:
        return _core.collide_batch(
            *bodies,
            count,
            of_a,
            of_b,
            shells,
            as_margin(margin),
            as_threads(threads),
            progress,
        )
    except PoseError as error:
        return collide_batch(
            a,
            b,
            **mend_poses(error, a_poses=a_poses, b_poses=b_poses),
            shell=shell,
            margin=margin,
            threads=threads,
            progress=progress,
        )
