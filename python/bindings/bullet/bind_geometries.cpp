#include <string>
#include <utility>
#include <vector>

#include <nanobind/stl/array.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/shared_ptr.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/variant.h>
#include <nanobind/stl/vector.h>

#include "arrays.h"
#include "bullet/bindings.h"
#include "bullet/conversions.h"
#include "bullet/shapes.h"
#include "in_ordinary_floats.h"

namespace nb = nanobind;

namespace voxshell::python {

void bind_geometries(nb::module_& module) {
  nb::class_<ModelGeometry>(module, "ModelGeometry")
      .def(
          "__init__",
          [](ModelGeometry* self, std::shared_ptr<const Model> model) {
            new (self) ModelGeometry{std::move(model)};
          },
          nb::sig("def __init__(self, model: voxshell._core.Model) -> None"));
  nb::class_<PlaneGeometry>(module, "PlaneGeometry")
      .def("__init__", [](PlaneGeometry* self, const Coordinates& normal, double offset) {
        new (self) PlaneGeometry{to_vec3(normal), offset};
      });
  nb::class_<BoxGeometry>(module, "BoxGeometry")
      .def("__init__", [](BoxGeometry* self, const Coordinates& half_extents) {
        new (self) BoxGeometry{to_vec3(half_extents)};
      });
  nb::class_<SphereGeometry>(module, "SphereGeometry")
      .def("__init__",
           [](SphereGeometry* self, double radius) { new (self) SphereGeometry{radius}; });
  nb::class_<CapsuleGeometry>(module, "CapsuleGeometry")
      .def("__init__", [](CapsuleGeometry* self, double radius, double length) {
        new (self) CapsuleGeometry{radius, length};
      });
  nb::class_<CylinderGeometry>(module, "CylinderGeometry")
      .def("__init__", [](CylinderGeometry* self, double radius, double length) {
        new (self) CylinderGeometry{radius, length};
      });
  nb::class_<ConeGeometry>(module, "ConeGeometry")
      .def("__init__", [](ConeGeometry* self, double radius, double height) {
        new (self) ConeGeometry{radius, height};
      });
  nb::class_<GImpactGeometry>(module, "GImpactGeometry")
      .def("__init__", [](GImpactGeometry* self, const PointsArray& vertices,
                          const FacesArray& faces, double margin) {
        new (self) GImpactGeometry{read_points(vertices), read_triangles(faces), margin};
      });
  nb::class_<HullsGeometry>(module, "HullsGeometry")
      .def("__init__",
           [](HullsGeometry* self, const std::vector<PointsArray>& hulls, double margin) {
             std::vector<std::vector<Vec3>> points;
             for (const PointsArray& hull : hulls) points.push_back(read_points(hull));
             new (self) HullsGeometry{std::move(points), margin};
           });
  nb::class_<CompoundGeometry>(module, "CompoundGeometry")
      .def(
          "__init__",
          [](CompoundGeometry* self,
             const std::vector<std::pair<PartGeometry, PoseMatrix>>& parts) {
            CompoundGeometry compound;
            for (const auto& [geometry, pose] : parts)
              compound.parts.push_back({geometry, to_pose(pose)});
            new (self) CompoundGeometry(std::move(compound));
          },
          InOrdinaryFloats());
  module.def(
      "triangulate_hulls",
      [](const std::vector<PointsArray>& hulls) {
        std::vector<std::vector<Vec3>> points;
        for (const PointsArray& hull : hulls) points.push_back(read_points(hull));
        const HullMesh mesh = triangulate_hulls(points);
        std::vector<std::array<double, 3>> vertices;
        for (const Vec3& p : mesh.vertices) vertices.push_back({p.x, p.y, p.z});
        return std::pair(to_array(vertices), to_array(mesh.triangles));
      },
      nb::arg("hulls"), InOrdinaryFloats(),
      "Return vertices (n, 3) and triangles (m, 3) of the hulls of sets of points.");
  module.def(
      "mesh_mass_properties",
      [](const PointsArray& vertices, const FacesArray& faces, const std::string& kind) {
        const auto mesh =
            unwrap(TriangleMesh::create(read_points(vertices), read_triangles(faces)));
        const MassProperties m = kind == "surface" ? compute_surface_mass_properties(mesh)
                                                   : compute_solid_mass_properties(mesh);
        return std::pair(
            to_coordinates(m.center_of_mass),
            std::array{to_coordinates(m.inertia.row_x), to_coordinates(m.inertia.row_y),
                       to_coordinates(m.inertia.row_z)});
      },
      nb::arg("vertices"), nb::arg("faces"), nb::arg("kind"), InOrdinaryFloats(),
      "Return center of mass and inertia tensor about it at 1 kg; kind is 'solid' or 'surface'.");
  module.def(
      "sample_hull",
      [](const PointsArray& points) {
        std::vector<std::array<double, 3>> rows;
        for (const Vec3& p : sample_hull(read_points(points))) rows.push_back({p.x, p.y, p.z});
        return to_array(std::move(rows));
      },
      nb::arg("points"), InOrdinaryFloats(),
      "Return vertices of the hull in the 42 directions of btShapeHull, (n, 3).");
}

}  // namespace voxshell::python
