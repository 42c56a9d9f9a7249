#pragma once

#include <cstddef>

#include "voxshell/model.h"

namespace voxshell::benchmarks {

/// Bytes that a model's parts hold.
struct ModelMemory {
  std::size_t field = 0;
  std::size_t shell = 0;  ///< normals, areas
  std::size_t tree = 0;   ///< spheres, points
  std::size_t mesh = 0;

  std::size_t total() const { return field + shell + tree + mesh; }
};

inline ModelMemory compute_memory(const Model& model) {
  ModelMemory memory;
  memory.field = model.grid().nbytes();
  const PointShell& shell = model.shell();
  memory.shell = shell.normals().size_bytes() + shell.areas().size_bytes();
  memory.tree = shell.tree().nbytes();
  memory.mesh = model.mesh().vertices().size_bytes() + model.mesh().triangles().size_bytes();
  return memory;
}

}  // namespace voxshell::benchmarks
