"""All tasks, by name, in the order of the page."""

from __future__ import annotations

from soak.task import Task
from soak.tasks import (
    cold_keys,
    field_values,
    fuzzing,
    hostile_inputs,
    killed_commands,
    kills,
    latency,
    memory,
    mutated_meshes,
    random_worlds,
    real_geometry,
    swept_motions,
    tree_poses,
    write_faults,
    wrong_arguments,
)

TASKS: dict[str, Task] = {
    "tree_poses": tree_poses.TASK,
    "swept_motions": swept_motions.TASK,
    "real_geometry": real_geometry.TASK,
    "field_values": field_values.TASK,
    "mutated_meshes": mutated_meshes.TASK,
    "wrong_arguments": wrong_arguments.TASK,
    "hostile_inputs": hostile_inputs.TASK,
    "kills": kills.TASK,
    "write_faults": write_faults.TASK,
    "killed_commands": killed_commands.TASK,
    "cold_keys": cold_keys.TASK,
    "fuzz_parsing": fuzzing.PARSING,
    "fuzz_queries": fuzzing.QUERIES,
    "random_worlds": random_worlds.TASK,
    "memory": memory.TASK,
    "latency": latency.TASK,
}
