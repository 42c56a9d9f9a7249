#include <cstdint>
#include <utility>
#include <vector>

#include "arrays.h"
#include "core_module.h"
#include "voxshell/point_shell.h"

namespace nb = nanobind;

namespace voxshell::python {
namespace {

auto compute_segments(const PointSphereTree& tree, int level) {
  std::vector<std::int64_t> segments;
  segments.reserve(tree.point_count());
  for (std::uint32_t id = 0; id < tree.point_count(); ++id) {
    segments.push_back(tree.segment(id, level));
  }
  return release<std::int64_t, nb::ndim<1>>(std::move(segments), {tree.point_count()});
}

/// Both ends of each segment, (m, 2, 3); empty without edges.
auto copy_edges(const PointShell& shell) {
  std::vector<float> ends;
  const EdgeSegments* edges = shell.edges();
  const std::size_t count = edges == nullptr ? 0 : edges->size();
  ends.reserve(6 * count);
  for (std::size_t i = 0; i < count; ++i) {
    const Vec3f middle = edges->middles()[i];
    const Vec3f half = edges->halves()[i];
    for (const Vec3f& end : {middle - half, middle + half}) {
      ends.insert(ends.end(), {end.x, end.y, end.z});
    }
  }
  return release<const float, nb::shape<-1, 2, 3>>(std::move(ends), {count, 2, 3});
}

/// The tree stores points coordinate by coordinate.
auto copy_points(const PointShell& shell) {
  const BucketPoints points = shell.points();
  std::vector<float> rows;
  rows.reserve(3 * points.size());
  for (const Vec3f& p : points) rows.insert(rows.end(), {p.x, p.y, p.z});
  return release<const float, nb::shape<-1, 3>>(std::move(rows), {points.size(), 3});
}

}  // namespace

void bind_shell(nb::module_& module) {
  nb::class_<PointShell>(module, "PointShell", "Points on a surface, in the order of their tree.")
      .def("__len__", &PointShell::size)
      // A separate array: by default, a property's array would refer to the shell's memory.
      .def_prop_ro("points", &copy_points, nb::rv_policy::automatic)
      .def_prop_ro("normals", [](const PointShell& s) { return view_rows<float, 3>(s.normals()); })
      .def_prop_ro("areas", [](const PointShell& s) { return view(s.areas()); })
      .def_prop_ro("edges", &copy_edges, nb::rv_policy::automatic)
      .def_prop_ro("spacing", &PointShell::spacing)
      .def_prop_ro("tree", &PointShell::tree);

  nb::class_<PointSphereTree>(module, "PointSphereTree", "Nested clusters of a shell's points.")
      .def_prop_ro_static("branching", [](nb::handle) { return PointSphereTree::kBranching; })
      .def_prop_ro_static("deepest_level", [](nb::handle) { return PointSphereTree::kMaxLevel; })
      .def_prop_ro("levels", &PointSphereTree::level_count)
      .def(
          "spheres",
          [](const PointSphereTree& t, int level) { return view_rows<float, 4>(t.spheres(level)); },
          nb::arg("level"), nb::rv_policy::reference_internal,
          "Return centers and radii, (m, 4); level 1 to levels.")
      .def("segments", &compute_segments, nb::arg("level"),
           "Return the cluster of each point, (n,); level 1 to deepest_level.");
}

}  // namespace voxshell::python
