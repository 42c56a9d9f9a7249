#include "voxshell/pose.h"

#include <algorithm>
#include <cmath>

#include "base/text.h"

namespace voxshell {
namespace {

constexpr double kRigidTolerance = 1e-6;

/// Meters. Beyond, the squares of coordinates would overflow float32, and products of poses
/// float64.
constexpr double kFarthest = 1e15;

}  // namespace

Result<Pose> Pose::from_matrix(const std::array<double, 16>& matrix) {
  for (const double entry : matrix) {
    if (!std::isfinite(entry)) {
      return Error{ErrorCode::kInvalidPose, "pose has an entry that is not finite"};
    }
  }
  const double last_row_error = std::max({std::abs(matrix[12]), std::abs(matrix[13]),
                                          std::abs(matrix[14]), std::abs(matrix[15] - 1.0)});
  if (last_row_error > kRigidTolerance) {
    return Error{
        ErrorCode::kInvalidPose,
        format_text("pose's last row must be 0, 0, 0, 1, and is off by %.3g; pass a rigid, "
                    "row-major world_from_body matrix",
                    last_row_error)};
  }
  const Pose pose{{{matrix[0], matrix[1], matrix[2]},
                   {matrix[4], matrix[5], matrix[6]},
                   {matrix[8], matrix[9], matrix[10]}},
                  {matrix[3], matrix[7], matrix[11]}};
  const Vec3& x = pose.rotation.row_x;
  const Vec3& y = pose.rotation.row_y;
  const Vec3& z = pose.rotation.row_z;
  const double orthonormal_error =
      std::max({std::abs(dot(x, x) - 1.0), std::abs(dot(y, y) - 1.0), std::abs(dot(z, z) - 1.0),
                std::abs(dot(x, y)), std::abs(dot(y, z)), std::abs(dot(z, x))});
  if (orthonormal_error > kRigidTolerance) {
    return Error{
        ErrorCode::kInvalidPose,
        format_text("pose's rotation is not orthonormal (error %.3g, at most 1e-6); scale the "
                    "mesh, not the pose",
                    orthonormal_error)};
  }
  const Vec3& t = pose.translation;
  const double farthest = std::max({std::abs(t.x), std::abs(t.y), std::abs(t.z)});
  if (farthest > kFarthest) {
    return Error{ErrorCode::kInvalidPose,
                 format_text("pose is %.3g m from its origin, beyond %.0e m", farthest, kFarthest)};
  }
  if (dot(cross(x, y), z) < 0.0) {
    return Error{ErrorCode::kInvalidPose,
                 "pose mirrors (its rotation has determinant -1); mirror the mesh, not the pose"};
  }
  return pose;
}

}  // namespace voxshell
