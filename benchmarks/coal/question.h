#pragma once

#include <cstddef>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "voxshell/pose.h"
#include "voxshell/triangle_mesh.h"

namespace voxshell::benchmarks {

/// One way to tell whether two bodies touch at the n-th pose of a set.
struct Question {
  std::string name;
  std::function<bool(std::size_t pose)> ask;
};

/// coal's ways, of a mesh with itself: the trees in which it compares without a copy of the mesh a
/// pose, as fast as it has them for this question, and one with its settings left as they come.
/// Trees and transforms are made here, beforehand.
std::vector<Question> make_coal_questions(const TriangleMesh& mesh,
                                          std::span<const Pose> world_from_a);

}  // namespace voxshell::benchmarks
