"""Settings of the study of geometry."""

from __future__ import annotations

from dataclasses import dataclass

from voxshell.base.arguments import as_integer

from voxshell_studies.scenes.geometry import BUILT, PAIRS, SCENES
from voxshell_studies.settings import check_scenes


@dataclass(frozen=True)
class GeometrySettings:
    """Settings of the study.

    Attributes:
        scenes: Names of scenes; empty for all.
        poses: Poses of each scene.
        rotations: Copies of each scene whose meshes are rotated before they are built.
        retriangulated: Copies with other triangles on the same surfaces: 1 or 0.
        copied_poses: Poses of each copy.
        judged: Largest number of contacts of a query that are judged.
        judged_pairs: Poses in which thin bodies meet each of two others, likewise; 0 for none.
        pairs: Number of pairs of mixed size, in any pose, from the start of the list.
        pair_poses: Poses of all pairs together.
        optimized: Poses that are tried to worsen each of the three worst ones of a pair.
        builds: Number of bodies whose builds are timed, from the start of the list.
        compared_poses: Poses of a body on itself in which queries of a model by tolerance and of a
            uniform one are timed; 0 for none.
        compared_resolution: Voxels of that uniform model along its longest side.
        seed: Seed of poses and rotations.
    """

    scenes: tuple[str, ...] = ()
    poses: int = 6
    rotations: int = 10
    retriangulated: int = 1
    copied_poses: int = 2
    judged: int = 24
    judged_pairs: int = 40
    pairs: int = len(PAIRS)
    pair_poses: int = 10_000
    optimized: int = 60
    builds: int = len(BUILT)
    compared_poses: int = 300
    compared_resolution: int = 300
    seed: int = 18

    def __post_init__(self) -> None:
        for name, least, most in (
            ("poses", 1, 1_000_000),
            ("rotations", 0, 1_000),
            ("retriangulated", 0, 1),
            ("copied_poses", 1, 1_000_000),
            ("judged", 1, 1_000_000),
            ("judged_pairs", 0, 1_000_000),
            ("pairs", 0, len(PAIRS)),
            ("pair_poses", 1, 100_000_000),
            ("optimized", 0, 1_000_000),
            ("builds", 0, len(BUILT)),
            ("compared_poses", 0, 1_000_000),
            ("compared_resolution", 10, 1_000),
            ("seed", 0, 2**31 - 1),
        ):
            as_integer(getattr(self, name), name, least, most)
        check_scenes(self.scenes, SCENES)

    @property
    def chosen(self) -> tuple[str, ...]:
        """Names of the chosen scenes."""
        return self.scenes or tuple(SCENES)
