"""Limits for mesh files, so that a small file cannot take minutes or all memory."""

from __future__ import annotations

from typing import TYPE_CHECKING

from voxshell.errors import MeshError

if TYPE_CHECKING:
    from collections.abc import Hashable, Mapping, Sequence

MOST_BYTES = 4_000_000_000
"""Limit for a file and for each file that it refers to, bytes. A binary STL file of 80 million
triangles has this size; reading it takes several times as much memory."""

MOST_TIMES_LARGER = 100
"""Limit for the expansion of a file. Meshes compress 3 to 20 times, zeros a thousand times."""

ALWAYS_FREE = 50_000_000
"""Size to which any file may expand, bytes; reading it takes less than a second."""

MOST_CORNERS = 1000
"""Corners of a face. The time to build a model grows with their square: 1.5 s for 1000, 100 s for
16,000. Faces with more corners are outlines from CAD programs, and their triangle fans overlap."""

MOST_PLACED = 20_000
"""Nodes and surfaces that a scene may place; trimesh takes 0.1 ms for each."""

MOST_PLACED_BYTES = 200_000_000
"""Limit for the total size of parts; each counts as often as the scene places it."""

MOST_CHAIN_WORK = 20_000_000
"""Limit for the sum, over all placed parts, of the cube of the number of transforms above them.
trimesh takes 0.06 us for each unit, to choose the order of multiplication."""


def check_size(size: int) -> None:
    """Refuse a file that is too large to read.

    Raises:
        MeshError: The file is too large.
    """
    if size > MOST_BYTES:
        raise MeshError(
            f"it has {_in_words(size)}; at most {_in_words(MOST_BYTES)} are read; simplify the mesh"
        )


def check_expansion(expanded: int, stored: int) -> None:
    """Refuse a file that would expand to far more than it holds.

    Args:
        expanded: Bytes that a library would allocate.
        stored: Bytes in the file.

    Raises:
        MeshError: It would expand too much.
    """
    if expanded > max(ALWAYS_FREE, MOST_TIMES_LARGER * stored):
        raise MeshError(
            f"it holds {_in_words(stored)} and expands to {_in_words(expanded)}, more than "
            f"{MOST_TIMES_LARGER} times as much; it is damaged, or made to exhaust memory: export the "
            "mesh again"
        )
    check_size(expanded)


def check_corners(corners: int) -> None:
    """Refuse a face of too many corners.

    Raises:
        MeshError: It has too many.
    """
    if corners > MOST_CORNERS:
        raise MeshError(
            f"a face has {corners} corners; at most {MOST_CORNERS} are read; triangulate it and "
            "export the mesh again"
        )


def check_parts(count: int, most: int) -> None:
    """Refuse a file of too many parts: trimesh makes them one by one, even if they are not placed.

    Raises:
        MeshError: It has too many.
    """
    if count > most:
        raise MeshError(f"it has {count} parts; at most {most} are read; merge them into one mesh")


def check_placed(
    children: Mapping[Hashable, Sequence[Hashable]],
    roots: Sequence[Hashable],
    sizes: Mapping[Hashable, int],
    most: int = MOST_PLACED,
) -> None:
    """Refuse a scene that places its parts too often, or that nests them too deeply.

    Args:
        children: The parts that each part places; repeated parts occur repeatedly.
        roots: The parts that the scene places directly.
        sizes: Bytes of the parts that have their own surface.
        most: Largest number of placed parts.

    Raises:
        MeshError: It does, or a part contains itself.
    """
    order = _sort(children, roots)
    counts: dict[Hashable, int] = dict.fromkeys(order, 0)
    depths: dict[Hashable, int] = dict.fromkeys(order, 1)
    for root in roots:
        counts[root] += 1
    placed = size = work = 0
    for part in order:
        count = counts[part]
        placed += count
        if part in sizes:
            size += count * sizes[part]
            work += count * depths[part] ** 3
        # Stop at the budget: arithmetic on huge integers would be slow.
        if placed > most:
            raise MeshError(
                f"its scene places more than {most} parts, each as often as another one contains it; "
                "merge them into one mesh"
            )
        if work > MOST_CHAIN_WORK:
            raise MeshError(
                f"its parts are nested too deeply, {depths[part]} levels; apply their transforms and "
                "export the mesh again"
            )
        if size > MOST_PLACED_BYTES:
            raise MeshError(
                f"its scene places parts so often that they take more than "
                f"{_in_words(MOST_PLACED_BYTES)}; export the parts one by one"
            )
        for child in children.get(part, ()):
            counts[child] += count
            depths[child] = max(depths[child], depths[part] + 1)


def _sort(
    children: Mapping[Hashable, Sequence[Hashable]], roots: Sequence[Hashable]
) -> list[Hashable]:
    """Return the reachable parts, each before its children."""
    waiting: dict[Hashable, int] = {}
    reached = list(dict.fromkeys(roots))
    known = set(reached)
    for part in reached:
        for child in children.get(part, ()):
            if child not in known:
                known.add(child)
                reached.append(child)
            waiting[child] = waiting.get(child, 0) + 1
    order = [part for part in reached if part not in waiting]
    for part in order:
        for child in children.get(part, ()):
            waiting[child] -= 1
            if waiting[child] == 0:
                order.append(child)
    if len(order) < len(reached):
        raise MeshError("its scene has parts that contain themselves; export the mesh again")
    return order


def _in_words(size: int) -> str:
    for unit, factor in (("GB", 10**9), ("MB", 10**6), ("kB", 10**3)):
        if size >= factor:
            return f"{size / factor:.3g} {unit}"
    return f"{size} bytes"
