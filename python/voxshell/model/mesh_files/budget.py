"""How much a mesh file may ask for, so that a small file cannot take minutes or all memory."""

from __future__ import annotations

from typing import TYPE_CHECKING

from voxshell.errors import MeshError

if TYPE_CHECKING:
    from collections.abc import Hashable, Mapping, Sequence

MOST_BYTES = 4_000_000_000
"""Of a file, and of one that it refers to. A binary STL file of 80 million triangles has as many;
reading takes several times that in memory."""

MOST_TIMES_LARGER = 100
"""How much more than it holds a file may expand to. Meshes compress 3 to 20 times; zeros a thousand."""

ALWAYS_FREE = 50_000_000
"""Bytes that any file may expand to; they are read within a second."""

MOST_CORNERS = 1000
"""Of one face. Building a model takes time that grows as their square: 1.5 s for 1000, 100 s for
16,000. Faces of more corners are outlines of CAD programs, whose fans of triangles overlap, too."""

MOST_PLACED = 20_000
"""Nodes and surfaces that a scene may place; trimesh takes 0.1 ms for each."""

MOST_PLACED_BYTES = 200_000_000
"""That parts may take together, each counted as often as a scene places it."""

MOST_CHAIN_WORK = 20_000_000
"""Sum, over the places of parts, of the cube of the number of transforms above: what trimesh takes to
choose an order in which to multiply them, 0.06 us each."""


def check_size(size: int) -> None:
    """Refuses a file that is too large to read.

    Raises:
        MeshError: It is.
    """
    if size > MOST_BYTES:
        raise MeshError(
            f"it has {_in_words(size)}, and at most {_in_words(MOST_BYTES)} are read; simplify the mesh"
        )


def check_expansion(expanded: int, stored: int) -> None:
    """Refuses a file that would expand to far more than it holds.

    Args:
        expanded: Bytes that a library would allocate.
        stored: Bytes that there are.

    Raises:
        MeshError: It would.
    """
    if expanded > max(ALWAYS_FREE, MOST_TIMES_LARGER * stored):
        raise MeshError(
            f"it holds {_in_words(stored)} and expands to {_in_words(expanded)}, over "
            f"{MOST_TIMES_LARGER} times as much; it is damaged, or made to exhaust memory: export the "
            "mesh again"
        )
    check_size(expanded)


def check_corners(corners: int) -> None:
    """Refuses a face of very many corners.

    Raises:
        MeshError: It has.
    """
    if corners > MOST_CORNERS:
        raise MeshError(
            f"a face has {corners} corners, and at most {MOST_CORNERS} are read; triangulate it and "
            "export the mesh again"
        )


def check_parts(count: int, most: int) -> None:
    """Refuses a file of very many parts, which are made one by one, placed or not.

    Raises:
        MeshError: It has more.
    """
    if count > most:
        raise MeshError(
            f"it has {count} parts, and at most {most} are read; merge them into one mesh"
        )


def check_placed(
    children: Mapping[Hashable, Sequence[Hashable]],
    roots: Sequence[Hashable],
    sizes: Mapping[Hashable, int],
    most: int = MOST_PLACED,
) -> None:
    """Refuses a scene that places its parts too often, or through too many other parts.

    Args:
        children: What each part places, as often as it does.
        roots: What the scene places itself.
        sizes: Bytes of the parts that have a surface of their own.
        most: Parts that may be placed.

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
        # Beyond the budget only the fact counts: numbers of any length would take long themselves.
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
    """What can be reached, each part before its children."""
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
