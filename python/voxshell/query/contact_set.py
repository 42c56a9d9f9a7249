"""The contacts of a pair."""

from __future__ import annotations

import operator
from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal, NoReturn

import numpy as np

from voxshell import _core
from voxshell.base.arguments import as_integer
from voxshell.base.lengths import in_millimeters
from voxshell.base.near_names import know_near_names
from voxshell.base.notebook import make_table
from voxshell.errors import InputTypeError

if TYPE_CHECKING:
    from collections.abc import Iterator

    from numpy.typing import NDArray

    from voxshell._core import ContactSet

ROLES: dict[_core.Role, Literal["a", "b", "both"]] = {
    _core.Role.A: "a",
    _core.Role.B: "b",
    _core.Role.BOTH: "both",
}
"""Names of the core's roles: the body whose points are tested."""
_NAMES = np.array(["a", "b"])


def name_shells(shells: NDArray[np.uint8]) -> NDArray[np.str_]:
    """Return the names of the core's numbers, read-only."""
    names = _NAMES[shells]
    names.flags.writeable = False
    return names


@dataclass(frozen=True, eq=False, slots=True)
class Contact:
    """One contact of two bodies a and b, in the world frame; an item of :class:`Contacts`.

    Attributes:
        point_a: Contact point on the surface of a, (3,) float64, meters.
        point_b: Contact point on the surface of b, (3,) float64, meters.
        normal: Unit normal, (3,) float64: from b toward a.
        depth: Penetration depth, meters; positive inside.
        id: Id of the contact's shell element; see :attr:`Contacts.ids`.
        segment: Cluster of the element at the query's level; 0 without a level.
        shell: The body whose shell the id belongs to: "a" or "b".
    """

    point_a: NDArray[np.float64]
    point_b: NDArray[np.float64]
    normal: NDArray[np.float64]
    depth: float
    id: int
    segment: int
    shell: Literal["a", "b"]


@know_near_names
class Contacts:
    """The contacts of two bodies a and b, as parallel arrays; from :func:`voxshell.contacts`.

    Each contact is a point of one body's shell that is inside the other body, or nearer to it than
    the margin. The arrays are in the world frame, read-only, and stay valid without this object.
    Contacts can be counted, indexed and iterated over, one :class:`Contact` at a time; for many of
    them, arrays are faster.

    Example:
        >>> import trimesh
        >>> import voxshell as vx
        >>> ball = vx.Model.from_mesh(trimesh.creation.icosphere(radius=0.1), voxel_size=0.01)
        >>> contacts = vx.contacts(ball, vx.Plane(offset=-0.099))
        >>> contacts
        Contacts(5 of a's points, deepest 0.001 m)
        >>> len(contacts), round(max(contact.depth for contact in contacts), 6), contacts[0].normal
        (5, 0.001, array([0., 0., 1.]))
    """

    __slots__ = ("_core",)

    def __init__(self, core: ContactSet) -> None:
        self._core = core

    def __len__(self) -> int:
        return len(self._core)

    def __getitem__(self, index: int) -> Contact:
        """Return a contact; negative indices count from the end.

        Raises:
            IndexError: There is no such contact.
            InputTypeError: The index is not an integer; the arrays have slices and masks.
        """
        try:
            place = operator.index(index)
        except TypeError:
            raise InputTypeError(
                f"contacts are indexed by integers, not {type(index).__name__}: take slices and masks of the arrays, "
                "as in contacts.points_b[contacts.depths > 0.001]"
            ) from None
        if not -len(self) <= place < len(self):
            raise IndexError(f"contact {place} of {len(self)}")
        return next(self._iterate(slice(place, place + 1 or None)))

    def __iter__(self) -> Iterator[Contact]:
        return self._iterate(slice(None))

    def _iterate(self, which: slice) -> Iterator[Contact]:
        columns = (
            self.points_a[which],
            self.points_b[which],
            self.normals[which],
            self.depths[which].tolist(),
            self.ids[which].tolist(),
            self.segments[which].tolist(),
            self.shells[which].tolist(),
        )
        return (Contact(*row) for row in zip(*columns, strict=True))

    @property
    def points_a(self) -> NDArray[np.float64]:
        """Contact points on the surface of a, (n, 3) float64, meters."""
        return self._core.points_a

    @property
    def points_b(self) -> NDArray[np.float64]:
        """Contact points on the surface of b, (n, 3) float64, meters.

        ``points_b - points_a == depths * normals`` up to rounding.
        """
        return self._core.points_b

    @property
    def normals(self) -> NDArray[np.float64]:
        """Unit normals, (n, 3) float64: from b toward a. Moving a along them separates the bodies."""
        return self._core.normals

    @property
    def depths(self) -> NDArray[np.float64]:
        """Penetration depths, (n,) float64, meters: positive inside, and above ``-margin``."""
        return self._core.depths

    @property
    def ids(self) -> NDArray[np.int64]:
        """Ids of the contacts' shell elements, (n,) int64: rows of ``model.shell.points``.

        Ids from ``len(model.shell)`` on, minus that number, are rows of ``model.shell.edges``. The
        ids of :attr:`ambiguous` contacts that belong to no element follow those of edges.
        """
        return self._core.ids

    @property
    def segments(self) -> NDArray[np.int64]:
        """Cluster of each element at the query's level, (n,) int64; 0 without a level.

        The clusters of edge segments are numbered after those of points.
        """
        return self._core.segments

    @property
    def shell(self) -> Literal["a", "b", "both"]:
        """The body whose points were tested: "a", "b" or "both"."""
        return ROLES[self._core.role]

    @property
    def shells(self) -> NDArray[np.str_]:
        """For each contact, the body whose shell its id belongs to, (n,): "a" or "b"."""
        return name_shells(self._core.shells)

    @property
    def ambiguous(self) -> NDArray[np.bool_]:
        """True where depth and normal are ambiguous because another surface is about as near, (n,).

        This is the case in the middle of a wall, within 9 % of half its thickness; on the axis of a
        rod; and between faces that meet at less than 60 degrees. It is also the case deep inside a
        model, within a cell of the planes where two faces are equally near, if depth and normal
        lead to a place that is off the surface by more than a quarter voxel or 1.5 % of the depth.
        Only the other body's shape at the contact decides. Each access computes the array again.

        If one body lies wholly inside the other, or coincides with it, no part of the surface may
        be in contact. Then a contact at a place deep inside the body, with that place's depth,
        stands for the overlap. It is ambiguous, too, and its normal is zero where no direction is
        better than another.

        Example:
            >>> import numpy as np
            >>> import trimesh
            >>> import voxshell as vx
            >>> plate = vx.Model.from_mesh(trimesh.creation.box(extents=(0.2, 0.2, 0.001)))
            >>> sunk = np.eye(4)
            >>> sunk[2, 3] = 0.0205  # a cube's lower face lies in the middle of the plate
            >>> cube = vx.Model.from_mesh(trimesh.creation.box(extents=(0.041, 0.041, 0.041)))
            >>> contacts = vx.contacts(cube, plate, sunk, shell="a")
            >>> bool(contacts.ambiguous[contacts.depths > 0.00049].all())
            True
        """
        ambiguous = self._core.find_ambiguous()
        ambiguous.flags.writeable = False
        return ambiguous

    @property
    def exact(self) -> bool:
        """True if the query cannot have missed a contact. Without a budget, this is always so.

        Contacts that ``max_points`` leaves out do not count as missed.
        """
        return self._core.exact

    @property
    def depth_bound(self) -> float:
        """No missed contact is deeper than this, meters; minus infinity if :attr:`exact`."""
        return self._core.depth_bound

    def manifold(self, max_points: int = 4) -> Contacts:
        """Return up to four representative contacts: the deepest, then those that span most area.

        Args:
            max_points: From 1 to 4. Contacts that would add no area are left out.

        Returns:
            The chosen contacts in the order of choice; the deepest is first.

        Raises:
            SettingsError: ``max_points`` is out of range.

        Example:
            >>> import trimesh
            >>> import voxshell as vx
            >>> box = vx.Model.from_mesh(trimesh.creation.box(), resolution=20)
            >>> contacts = vx.contacts(box, vx.Plane(offset=-0.499))
            >>> len(contacts), len(contacts.manifold())
            (441, 4)
        """
        return Contacts(self._core.manifold(as_integer(max_points, "max_points", 1, 4)))

    def deepest_per_segment(self) -> Contacts:
        """Return the deepest contact of each segment at the query's level.

        Returns:
            One contact for each segment that has any, in ascending order of ids. For both shells,
            a's segments come before b's. Of equally deep contacts, the one with the smaller id is
            returned.

        Example:
            >>> import trimesh
            >>> import voxshell as vx
            >>> box = vx.Model.from_mesh(trimesh.creation.box(), resolution=20)
            >>> contacts = vx.contacts(box, vx.Plane(offset=-0.499), level=3)
            >>> deepest = contacts.deepest_per_segment()
            >>> len(deepest) == len(set(contacts.segments.tolist())) > 1
            True
        """
        return Contacts(self._core.deepest_per_segment())

    def __reduce__(self) -> NoReturn:
        raise InputTypeError(
            "Contacts cannot be pickled or copied: pass the arrays, such as contacts.points_b, "
            "contacts.normals and contacts.depths"
        )

    def _repr_html_(self) -> str:
        """Return a table of facts for notebooks."""
        facts = {"contacts": self._count_by_shell()}
        if len(self) > 0:
            deepest = int(np.argmax(self.depths))
            # Less than a tenth of a micrometer, or of a thousandth of a degree, is rounding.
            place = ", ".join(f"{x:.6g}" for x in self.points_b[deepest].round(7) + 0.0)
            normal = ", ".join(f"{x:.3g}" for x in self.normals[deepest].round(6) + 0.0)
            facts |= {
                "depth": f"{in_millimeters(self.depths.min(), 4)} to {in_millimeters(self.depths.max(), 4)} mm",
                "deepest at": f"({place}) m, world frame",
                "normal there": f"({normal}), from b to a",
            }
        if not self.exact:
            facts["missing"] = "perhaps some: the budget ended the search"
            if np.isfinite(self.depth_bound):
                bound = in_millimeters(self.depth_bound, 4)
                facts["missing"] += f"; none is deeper than {bound} mm"
        return make_table("Contacts", facts)

    def _count_by_shell(self) -> str:
        if self.shell == "both":
            of_b = np.count_nonzero(self._core.shells)
            return f"{len(self) - of_b} of a's and {of_b} of b's points"
        return f"{len(self)} of {self.shell}'s points"

    def __repr__(self) -> str:
        text = self._count_by_shell()
        if len(self) > 0:
            text += f", deepest {round(self.depths.max(), 7) + 0.0:.3g} m"  # less is rounding
        return f"Contacts({text})" if self.exact else f"Contacts({text}, perhaps not all)"
