#!/usr/bin/env python3
"""Yes/no queries, bunny on bunny at random poses, beside coal's on the same meshes in one process.

`./dev bench --peers` builds the package and a C++ program, and calls this. The program asks both at
the same poses in one process; the bar is judged by its figures. Beside them stand calls from Python:
coal has none for many poses, so a loop of its calls stands beside our batch, and what a call costs
that has nothing to do is measured for both.

coal runs at its best for the question: transforms made beforehand, one contact asked for and not
computed, volumes and triangles known to be disjoint once anything parts them; from C++ the best of
three trees.
"""

from __future__ import annotations

import argparse
import json
import sys
import time
from collections.abc import Callable
from typing import Any

import coal
import numpy as np
import trimesh
import voxshell as vx
from beside_coal import LEAST_RATIO, judge, make_rows, run_program, summarize
from machine import ROOT, describe_machine
from voxshell_studies.scenes.bunny import find_bunny

OUT = ROOT / "build/bench"
BUNNY_LENGTH = 0.3
REACH = 0.3
NEAR = 0.002
SEED = 53


def random_poses(count: int) -> np.ndarray:
    """(count, 4, 4): any orientation, origins anywhere up to REACH apart."""
    rng = np.random.default_rng(SEED)
    poses = np.tile(np.eye(4), (count, 1, 1))
    for pose in poses:
        pose[:3, :3] = trimesh.transformations.random_rotation_matrix(rng.random(3))[:3, :3]
        direction = rng.normal(size=3)
        pose[:3, 3] = REACH * np.cbrt(rng.random()) * direction / np.linalg.norm(direction)
    return poses


def touching_poses(poses: np.ndarray, touches: Callable[[np.ndarray], bool]) -> np.ndarray:
    """The same, moved along the line of the origins to within NEAR of the first touch."""
    rng = np.random.default_rng(SEED + 1)
    moved = poses.copy()
    for pose in moved:
        direction = pose[:3, 3] / np.linalg.norm(pose[:3, 3])
        near, far = 0.0, 2.0 * REACH
        for _ in range(16):
            middle = 0.5 * (near + far)
            pose[:3, 3] = middle * direction
            near, far = (middle, far) if touches(pose) else (near, middle)
        pose[:3, 3] = (far + rng.uniform(-NEAR, NEAR)) * direction
    return moved


def make_coal_model(mesh: trimesh.Trimesh) -> coal.BVHModelOBBRSS:
    """The triangles in coal's tree."""
    model = coal.BVHModelOBBRSS()
    model.beginModel(len(mesh.faces), len(mesh.vertices))
    vertices = coal.StdVec_Vec3s()
    vertices.extend(np.asarray(mesh.vertices, dtype=float))
    triangles = coal.StdVec_Triangle()
    triangles.extend([coal.Triangle(*(int(i) for i in face)) for face in mesh.faces])
    model.addSubModel(vertices, triangles)
    model.endModel()
    return model


def time_in_turn(
    asks: dict[str, tuple[Callable[[Any], bool], list[Any]]], repeats: int
) -> dict[str, np.ndarray]:
    """Seconds of each query, (repeats, poses); one after another asks about all its poses.

    So what else the machine does hits all of them alike.
    """
    seconds = {name: np.empty((repeats, len(poses))) for name, (_, poses) in asks.items()}
    for repeat in range(repeats):
        for name, (ask, poses) in asks.items():
            row = seconds[name][repeat]
            for i, pose in enumerate(poses):
                start = time.perf_counter()
                ask(pose)
                row[i] = time.perf_counter() - start
    return seconds


def tell_verdict(verdict: dict[str, Any]) -> list[str]:
    """A line for each way that coal is set."""
    lines = []
    for name, said in verdict.items():
        ratios = f"{said['median_us']:.3g} (median), {said['mean_us']:.3g} (mean)"
        lines.append(f"{name} / voxshell, C++: {ratios}: {'yes' if said['holds'] else 'no'}")
    return lines


def print_results(results: dict[str, Any]) -> None:
    """A small table a pose set, and whether the bar is held."""
    print(f"{results['machine']['cpu']}, commit {results['machine']['commit']}")
    build = results["sets"]["random"]["build"]
    print(f"{build['compiler']} {build['flags']}")
    print(results["model"])
    for name, measured in results["sets"].items():
        print(
            f"\n{results['poses']} poses, {name}: {measured['fraction_in_contact']:.0%} in contact, "
            f"same answer as coal {results['coal']}\nin {measured['fraction_that_agree_in_cpp']:.1%} "
            f"from C++, in {measured['fraction_that_agree']:.1%} from Python"
        )
        print(f"{'microseconds':27} {'median':>8} {'mean':>8} {'p99':>8}  coal / this")
        for label, case in measured["cases"].items():
            columns = [
                f"{case[figure]:8.3g}" if figure in case else " " * 8
                for figure in ("median_us", "mean_us", "p99_us")
            ]
            ratios = [case[f"coal_over_{f}"] for f in ("median_us", "mean_us") if f in case]
            print(f"{label:27} {' '.join(columns)}  {', '.join(f'{r:.3g}' for r in ratios)}")
    empty = results["empty_call_us"]
    print(
        "\nC++ rows are compared with coal's, calls from Python and batches with its calls."
        f"\nA call with nothing to do takes {empty['coal']:.2g} us of coal's and "
        f"{empty['voxshell']:.2g} us of voxshell's;"
        "\nbatches make one such call for all poses. As it comes: coal's break_distance is\n"
        "1 mm, which yes or no does not need; it is 0 in its other rows."
        f"\n\nIs it {LEAST_RATIO:g} times faster at random poses?"
    )
    for line in tell_verdict(results["verdict"]):
        print(f"  {line}")


def main(arguments: list[str]) -> int:
    """The command line; returns the exit code."""
    parser = argparse.ArgumentParser(prog="./dev bench --peers")
    parser.add_argument("--poses", type=int, default=2_400)
    parser.add_argument("--repeats", type=int, default=5)
    parser.add_argument("--resolution", type=int, default=300, help="voxels along the bunny")
    parser.add_argument("--target-points", type=int, default=34_835)
    parser.add_argument("--json", action="store_true", help="print the results as JSON alone")
    options = parser.parse_args(arguments)

    bunny = find_bunny()
    mesh = trimesh.load_mesh(bunny, process=False)
    mesh.apply_translation(-mesh.bounds.mean(axis=0))
    mesh.apply_scale(BUNNY_LENGTH / mesh.extents.max())
    model = vx.Model.from_mesh(
        mesh, resolution=options.resolution, target_points=options.target_points
    )
    coal_model = make_coal_model(mesh)
    poses = random_poses(options.poses)

    identity = np.eye(4)
    coal_identity = coal.Transform3s.Identity()
    request = coal.CollisionRequest()
    request.num_max_contacts = 1
    request.enable_contact = False
    request.break_distance = 0.0
    request.distance_upper_bound = 0.0
    result = coal.CollisionResult()

    def ask_coal(pose: coal.Transform3s) -> bool:
        result.clear()
        return coal.collide(coal_model, pose, coal_model, coal_identity, request, result) > 0

    def ask_voxshell(pose: np.ndarray) -> bool:
        return vx.collide(model, model, pose, identity)

    def measure(poses: np.ndarray) -> dict[str, Any]:
        coal_poses = [coal.Transform3s(pose[:3, :3], pose[:3, 3]) for pose in poses]
        coal_answers = np.array([ask_coal(pose) for pose in coal_poses])
        answers = np.array([ask_voxshell(pose) for pose in poses])
        program = run_program(
            bunny, poses, options.resolution, options.target_points, options.repeats
        )
        rows = make_rows(program["questions"])
        calls = {
            "coal, calls": (ask_coal, coal_poses),
            "voxshell, calls": (ask_voxshell, list(poses)),
        }
        batches = {
            f"voxshell, batch, {label}": (
                lambda many, threads=threads: vx.collide_batch(model, model, many, threads=threads),
                [poses],
            )
            for label, threads in (("one thread", 1), ("all cores", None))
        }
        seconds = time_in_turn(calls | batches, options.repeats)
        cases = {name: summarize(seconds[name]) for name in calls}
        for name in batches:
            cases[name] = {"mean_us": 1e6 * float(np.median(seconds[name])) / len(poses)}
        for peer, group in (("coal, C++", rows["cases"]), ("coal, calls", cases)):
            for case in group.values():
                for figure in ("median_us", "mean_us"):
                    if figure in case:
                        case[f"coal_over_{figure}"] = group[peer][figure] / case[figure]
        return {
            "build": {name: program[name] for name in ("compiler", "flags")},
            "fraction_in_contact": float(coal_answers.mean()),
            "fraction_that_agree": float((answers == coal_answers).mean()),
            "fraction_that_agree_in_cpp": rows["fraction_that_agree"],
            "cases": rows["cases"] | cases,
            "coal_ways": rows["ways"],
        }

    def measure_empty_calls() -> dict[str, float]:
        """Of two small spheres that are far apart, and of the model and such a sphere."""
        far = np.eye(4)
        far[0, 3] = 100.0
        there = coal.Transform3s(far[:3, :3], far[:3, 3])
        sphere, our_sphere = coal.Sphere(1e-3), vx.Sphere(1e-3)
        asks: dict[str, Callable[[Any], bool]] = {
            "coal": lambda _: (
                result.clear()
                or coal.collide(sphere, there, sphere, coal_identity, request, result) > 0
            ),
            "voxshell": lambda _: vx.collide(model, our_sphere, far, identity),
        }
        return {
            name: summarize(seconds)["median_us"]
            for name, seconds in time_in_turn(
                {name: (ask, [None] * options.poses) for name, ask in asks.items()}, options.repeats
            ).items()
        }

    poses = random_poses(options.poses)
    results: dict[str, Any] = {
        "machine": describe_machine(),
        "coal": coal.__version__,
        "model": repr(model),
        "poses": len(poses),
        "empty_call_us": measure_empty_calls(),
        "sets": {
            "random": measure(poses),
            "within 2 mm of touching": measure(touching_poses(poses, ask_voxshell)),
        },
    }
    results["verdict"] = judge(results["sets"]["random"]["cases"])
    OUT.mkdir(parents=True, exist_ok=True)
    (OUT / "peers.json").write_text(json.dumps(results, indent=2) + "\n", encoding="utf-8")
    if options.json:
        print(json.dumps(results, indent=2))
        return 0
    print_results(results)
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
