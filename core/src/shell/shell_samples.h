#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "voxshell/edge_segments.h"
#include "voxshell/result.h"
#include "voxshell/vector.h"

namespace voxshell {

struct ShellPoint {
  Vec3f point;
  std::uint32_t triangle;  ///< of the sampled mesh
  double area;             ///< of the surface that the point stands for, m2
};

/// The contents of a point shell before its tree orders them.
struct ShellSamples {
  std::vector<ShellPoint> points;
  std::vector<Vec3f> normals;     ///< of the points; empty: each has the normal of its triangle
  double spacing = 0.0;           ///< edge of the largest sampling voxels, meters
  std::size_t samples_taken = 0;  ///< more than points where float32 cannot tell some apart
  std::optional<EdgeSegments> edges = {};
};

/// The error of a build that its progress asked to stop.
inline Error make_stopped_error() {
  return {ErrorCode::kCanceled, "building the point shell was stopped"};
}

}  // namespace voxshell
