#pragma once

#include <array>
#include <utility>
#include <vector>

#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>

#include "errors.h"
#include "pose_matrix.h"
#include "voxshell/pose.h"

namespace voxshell::python {

using Coordinates = std::array<double, 3>;

inline Vec3 to_vec3(const Coordinates& c) { return {c[0], c[1], c[2]}; }

inline Coordinates to_coordinates(const Vec3& v) { return {v.x, v.y, v.z}; }

inline Pose to_pose(const PoseMatrix& matrix) {
  return unwrap(Pose::from_matrix(matrix.numbers), "pose");
}

/// A new array with one row for each item.
template <class T, std::size_t Columns>
nanobind::ndarray<nanobind::numpy, T> to_array(std::vector<std::array<T, Columns>> rows) {
  using Items = std::vector<std::array<T, Columns>>;
  auto* owned = new Items(std::move(rows));
  nanobind::capsule owner(owned, [](void* p) noexcept { delete static_cast<Items*>(p); });
  return nanobind::ndarray<nanobind::numpy, T>(owned->data(), {owned->size(), Columns}, owner);
}

inline nanobind::ndarray<nanobind::numpy, double> to_matrix(const Pose& pose) {
  const Matrix3& r = pose.rotation;
  const Vec3& t = pose.translation;
  return to_array<double, 4>({{r.row_x.x, r.row_x.y, r.row_x.z, t.x},
                              {r.row_y.x, r.row_y.y, r.row_y.z, t.y},
                              {r.row_z.x, r.row_z.y, r.row_z.z, t.z},
                              {0.0, 0.0, 0.0, 1.0}});
}

}  // namespace voxshell::python
