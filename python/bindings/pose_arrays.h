#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>

#include "posed_pair.h"

namespace voxshell::python {

using PosesArray = nanobind::ndarray<const double, nanobind::shape<-1, 4, 4>, nanobind::c_contig,
                                     nanobind::device::cpu>;
using OptionalPoses = std::optional<PosesArray>;

/// `count` poses. A single pose applies to all; null is the identity.
inline std::vector<Pose> read_poses(const OptionalPoses& array, std::size_t count,
                                    const char* name) {
  if (!array) return std::vector<Pose>(count);
  if (array->shape(0) == 1) return std::vector<Pose>(count, read_matrix(array->data(), name));
  if (array->shape(0) != count) throw nanobind::value_error("not as many poses as counted");
  std::vector<Pose> poses;
  poses.reserve(count);
  for (std::size_t i = 0; i < count; ++i) {
    poses.push_back(
        read_matrix(array->data() + 16 * i, std::string(name) + "[" + std::to_string(i) + "]"));
  }
  return poses;
}

}  // namespace voxshell::python
