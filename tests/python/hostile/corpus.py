"""All cases."""

from __future__ import annotations

import functools

from . import (
    array_files,
    assumptions,
    found_files,
    gltf_files,
    mjcf_files,
    model_files,
    places,
    ply_files,
    pose_files,
    scene_files,
    stl_files,
    text_meshes,
    urdf_files,
    xml_meshes,
)
from .case import Case

SOURCES = (
    *(stl_files, text_meshes, ply_files, gltf_files, xml_meshes, model_files),
    *(
        scene_files,
        urdf_files,
        mjcf_files,
        pose_files,
        places,
        assumptions,
        found_files,
        array_files,
    ),
)


@functools.cache
def list_cases() -> tuple[Case, ...]:
    return tuple(case for source in SOURCES for case in source.list_cases())
