#include <array>
#include <cmath>
#include <cstddef>
#include <string>
#include <tuple>
#include <utility>
#include <variant>
#include <vector>

#include <nanobind/stl/array.h>
#include <nanobind/stl/tuple.h>

#include "arrays.h"
#include "core_module.h"
#include "errors.h"
#include "in_ordinary_floats.h"
#include "interpreter_lock.h"
#include "voxshell/field.h"

namespace nb = nanobind;

namespace voxshell::python {
namespace {

/// A field converts coordinates to integers to find the cell, so they must be ordinary numbers.
bool is_usable(const Vec3& p) {
  constexpr double kFarthest = 1e15;  // meters: squares still fit float32
  return std::abs(p.x) <= kFarthest && std::abs(p.y) <= kFarthest && std::abs(p.z) <= kFarthest;
}

/// Calls `visit(typed_field, p)` for each point in float32, without the GIL.
template <class Visit>
void for_each_point(const Field& field, const PointsArray& points, const Visit& visit) {
  const std::size_t count = points.shape(0);
  std::size_t done = 0;
  {
    const ReleasedInterpreter released;
    std::visit(
        [&](const auto& typed) {
          for (; done < count; ++done) {
            const Vec3 p = read_row(points.data() + 3 * done);
            if (!is_usable(p)) return;
            visit(typed, static_cast<Vec3f>(p));
          }
        },
        field);
  }
  if (done < count) {
    raise({ErrorCode::kInvalidArgument, "points must be finite and within 1e15 m; row " +
                                            std::to_string(done) + " of " + std::to_string(count) +
                                            " is not"});
  }
}

auto sample(const Field& field, const PointsArray& points) {
  std::vector<double> distances;
  distances.reserve(points.shape(0));
  for_each_point(field, points, [&](const auto& typed, const Vec3f& p) {
    distances.push_back(static_cast<double>(typed.distance(p)));
  });
  return release<double, nb::ndim<1>>(std::move(distances), {points.shape(0)});
}

auto gradient(const Field& field, const PointsArray& points) {
  std::vector<double> gradients;
  gradients.reserve(3 * points.shape(0));
  for_each_point(field, points, [&](const auto& typed, const Vec3f& p) {
    const auto g = static_cast<Vec3>(typed.gradient(p));
    gradients.insert(gradients.end(), {g.x, g.y, g.z});
  });
  return release<double, nb::shape<-1, 3>>(std::move(gradients), {points.shape(0), 3});
}

using Coordinates = std::array<double, 3>;

Vec3 to_vector(const Coordinates& c) { return {c[0], c[1], c[2]}; }

std::tuple<Field, std::size_t> make_convex_field(const PointsArray& vertices,
                                                 const FacesArray& faces) {
  auto mesh = unwrap(TriangleMesh::create(read_points(vertices), read_triangles(faces)));
  auto field = [&] {
    const ReleasedInterpreter released;
    return ConvexField::create(mesh);
  }();
  auto convex = unwrap(std::move(field));
  const std::size_t face_count = convex.face_count();
  return {std::move(convex), face_count};
}

}  // namespace

void bind_field(nb::module_& module) {
  nb::class_<Field>(module, "Field", "A signed distance field of any kind.")
      .def("sample", &sample, nb::arg("points"), InOrdinaryFloats(),
           "Return signed distances, meters, (n,).")
      .def("gradient", &gradient, nb::arg("points"), InOrdinaryFloats(),
           "Return gradients of the distance, (n, 3).");

  nb::class_<GridField>(module, "GridField", "Properties that only a sampled field has.")
      .def_prop_ro("shape", &GridField::shape)
      .def_prop_ro("voxel_size", &GridField::voxel_size)
      .def_prop_ro(
          "origin",
          [](const GridField& f) { return Coordinates{f.origin().x, f.origin().y, f.origin().z}; })
      .def_prop_ro("nbytes", &GridField::nbytes)
      .def_prop_ro("interpolation_error", &GridField::interpolation_error)
      .def_prop_ro("surface_error", &GridField::surface_error)
      .def_prop_ro("sign_method",
                   [](const GridField& f) {
                     return f.sign_report().method == SignMethod::kClosed ? "closed" : "winding";
                   })
      .def_prop_ro("sign_confidence", [](const GridField& f) { return f.sign_report().confidence; })
      .def_prop_ro("was_turned", [](const GridField& f) { return f.sign_report().was_turned; })
      .def_prop_ro(
          "faults",
          [](const GridField& f) {
            const SignReport& r = f.sign_report();
            return std::array{r.defects.open_edges, r.defects.non_manifold_edges,
                              r.defects.flipped_edges, r.overlaps, r.hidden_triangles};
          },
          "Open, non-manifold and wrongly oriented edges, nodes in overlaps, hidden triangles.")
      .def_prop_ro("first_fault", [](const GridField& f) {
        const Vec3& p = f.sign_report().first_location;
        return Coordinates{p.x, p.y, p.z};
      });

  module.def(
      "plane_field",
      [](const Coordinates& normal, double offset) {
        return Field(PlaneField{to_vector(normal), offset});
      },
      nb::arg("normal"), nb::arg("offset"), InOrdinaryFloats());
  module.def(
      "box_field",
      [](const Coordinates& half_extents) { return Field(BoxField{to_vector(half_extents)}); },
      nb::arg("half_extents"), InOrdinaryFloats());
  module.def(
      "sphere_field", [](double radius) { return Field(SphereField{radius}); }, nb::arg("radius"),
      InOrdinaryFloats());
  module.def(
      "capsule_field",
      [](double radius, double length) { return Field(CapsuleField{radius, length}); },
      nb::arg("radius"), nb::arg("length"), InOrdinaryFloats());
  module.def(
      "cylinder_field",
      [](double radius, double length) { return Field(CylinderField{radius, length}); },
      nb::arg("radius"), nb::arg("length"), InOrdinaryFloats());
  module.def(
      "cone_field", [](double radius, double height) { return Field(ConeField{radius, height}); },
      nb::arg("radius"), nb::arg("height"), InOrdinaryFloats());
  module.def("convex_field", &make_convex_field, nb::arg("vertices"), nb::arg("faces"),
             InOrdinaryFloats(), "Return the field and its number of faces.");
}

}  // namespace voxshell::python
