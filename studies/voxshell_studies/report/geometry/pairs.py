"""Report of the geometry study on pairs of mixed size, in any pose."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from voxshell_studies.scenes.geometry_bodies import make_body
from voxshell_studies.verdict import Row, at_most, format_value, in_mm

if TYPE_CHECKING:
    from voxshell_studies.geometry.study import GeometrySettings
    from voxshell_studies.part import Columns, Tables

LEAST_BOUND_BAR, BOUND_FRACTION_BAR = 1e-3, 1.0 / 4000.0
"""Stated bounds: meters, or this fraction of the larger body."""

SHARPNESS_BAR = 3.0
"""Stated bound over the worst overlap that is found to be denied."""

_ROUNDING = 1e-6


def judge_violations(name: str, tables: Tables) -> Row:
    """Return rows on whether stated bounds hold."""
    poses, worst = tables["poses"], tables["worst"]
    inside = poses["offset"] > 0.0
    stated = np.where(inside, poses["overlap"], poses["clearance"])
    violated = int((poses["proven"] > stated + _ROUNDING).sum())
    violated += int(worst["optimized"].max() > poses["overlap"].max() + _ROUNDING)
    denied = inside & (poses["overlaps"] == 1.0) & (poses["yes"] == 0.0)
    early = ~inside & (poses["yes"] == 1.0)
    return Row(
        f"answers wrong beyond the stated bounds, {name}",
        None,
        violated,
        f"of {len(stated):,}",
        bar="0",
        holds=violated == 0,
        note=f"{int(denied.sum()):,} overlaps denied, {int(early.sum()):,} gaps taken for contact",
    )


def tell_worst(name: str, worst: Columns) -> Row:
    """Return rows on the depth of the shell's surface in the other body where the answer is no."""
    return Row(
        f"worst overlap that is denied, {name}",
        None,
        float(worst["optimized"].max()) * 1e3,
        "mm",
        note=f"{in_mm(worst['random'].max())} by chance",
    )


def judge_bounds(name: str, poses: Columns) -> Row:
    """Return rows on the size of the stated bounds."""
    size = max(float(np.ptp(make_body(b).vertices, axis=0).max()) for b in name.split(" and "))
    most = max(LEAST_BOUND_BAR, BOUND_FRACTION_BAR * size)
    bound = float(max(poses["overlap"].max(), poses["clearance"].max()))
    return Row(
        f"stated bounds at most, {name}",
        None,
        bound * 1e3,
        "mm",
        bar=f"<= {format_value(most * 1e3)}",
        holds=at_most(bound, most),
        note=f"overlap {in_mm(poses['overlap'].max())}, clearance {in_mm(poses['clearance'].max())}",
    )


def judge_sharpness(settings: GeometrySettings, name: str, tables: Tables) -> Row:
    """Return rows on how close the worst pose comes to the bounds, by chance and after a search."""
    deepest = float(tables["worst"]["optimized"].max())
    sharpness = float(tables["poses"]["overlap"].max()) / deepest if deepest > 0.0 else np.inf
    return Row(
        f"stated bound over the worst overlap that is denied, {name}",
        None,
        sharpness,
        "times",
        bar=f"<= {SHARPNESS_BAR:g}" if settings.optimized else "",
        holds=at_most(sharpness, SHARPNESS_BAR) if settings.optimized else None,
    )
