#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <span>
#include <type_traits>
#include <utility>
#include <vector>

#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>

#include "voxshell/triangle_mesh.h"
#include "voxshell/vector.h"

namespace voxshell::python {

/// Arrays from the package, which has checked and converted shape and type before.
using PointsArray = nanobind::ndarray<const double, nanobind::shape<-1, 3>, nanobind::c_contig,
                                      nanobind::device::cpu>;
using FacesArray = nanobind::ndarray<const std::uint32_t, nanobind::shape<-1, 3>,
                                     nanobind::c_contig, nanobind::device::cpu>;

inline Vec3 read_row(const double* row) { return {row[0], row[1], row[2]}; }

/// Copies, which the core can use while other threads change the array.
inline std::vector<Vec3> read_points(const PointsArray& array) {
  std::vector<Vec3> points(array.shape(0));
  for (std::size_t i = 0; i < points.size(); ++i) points[i] = read_row(array.data() + 3 * i);
  return points;
}
inline std::vector<Triangle> read_triangles(const FacesArray& array) {
  std::vector<Triangle> triangles(array.shape(0));
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    const std::uint32_t* face = array.data() + 3 * i;
    triangles[i] = {face[0], face[1], face[2]};
  }
  return triangles;
}

/// Read-only views. If a property returns them, they keep its object alive.
template <class T>
using Row = nanobind::ndarray<nanobind::numpy, const T, nanobind::ndim<1>>;
template <class T, int Columns>
using Rows = nanobind::ndarray<nanobind::numpy, const T, nanobind::shape<-1, Columns>>;

template <class T>
Row<T> view(std::span<const T> values) {
  return Row<T>(values.data(), {values.size()});
}

/// One row of `Columns` scalars for each T: vectors, triangles, spheres.
template <class T, int Columns, class Item>
Rows<T, Columns> view_rows(std::span<const Item> items) {
  static_assert(sizeof(Item) == sizeof(T) * Columns && alignof(Item) == alignof(T));
  return Rows<T, Columns>(reinterpret_cast<const T*>(items.data()),
                          {items.size(), std::size_t{Columns}});
}

/// A new array that owns `values`; read-only if T is const.
template <class T, class... Shape>
nanobind::ndarray<nanobind::numpy, T, Shape...> release(std::vector<std::remove_const_t<T>> values,
                                                        std::initializer_list<std::size_t> shape) {
  using Values = std::vector<std::remove_const_t<T>>;
  auto* owned = new Values(std::move(values));
  const nanobind::capsule owner(owned, [](void* p) noexcept { delete static_cast<Values*>(p); });
  return nanobind::ndarray<nanobind::numpy, T, Shape...>(owned->data(), shape, owner);
}

}  // namespace voxshell::python
