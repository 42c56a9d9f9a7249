#include <array>
#include <string>
#include <vector>

#include <nanobind/nanobind.h>
#include <nanobind/stl/array.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/shared_ptr.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/variant.h>
#include <nanobind/stl/vector.h>

#include "arrays.h"
#include "bullet/shapes.h"
#include "bullet/simulation.h"
#include "errors.h"

namespace nb = nanobind;

namespace voxshell::python {
namespace {

using Coordinates = std::array<double, 3>;

Vec3 to_vec3(const Coordinates& c) { return {c[0], c[1], c[2]}; }

Coordinates to_coordinates(const Vec3& v) { return {v.x, v.y, v.z}; }

std::vector<Vec3> to_points(const PointsArray& array) {
  std::vector<Vec3> points;
  points.reserve(array.shape(0));
  for (std::size_t i = 0; i < array.shape(0); ++i) points.push_back(read_row(array.data() + 3 * i));
  return points;
}

std::vector<Triangle> to_triangles(const FacesArray& array) {
  std::vector<Triangle> triangles;
  triangles.reserve(array.shape(0));
  for (std::size_t i = 0; i < array.shape(0); ++i) {
    const std::uint32_t* row = array.data() + 3 * i;
    triangles.push_back({row[0], row[1], row[2]});
  }
  return triangles;
}

Pose to_pose(const PoseArray& array) {
  std::array<double, 16> matrix{};
  std::copy_n(array.data(), matrix.size(), matrix.begin());
  return unwrap(Pose::from_matrix(matrix), "pose");
}

/// A new array with one row an item.
template <class T, std::size_t Columns>
nb::ndarray<nb::numpy, T> to_array(std::vector<std::array<T, Columns>> rows) {
  using Items = std::vector<std::array<T, Columns>>;
  auto* owned = new Items(std::move(rows));
  nb::capsule owner(owned, [](void* p) noexcept { delete static_cast<Items*>(p); });
  return nb::ndarray<nb::numpy, T>(owned->data(), {owned->size(), Columns}, owner);
}

nb::ndarray<nb::numpy, double> to_matrix(const Pose& pose) {
  const Matrix3& r = pose.rotation;
  const Vec3& t = pose.translation;
  return to_array<double, 4>({{r.row_x.x, r.row_x.y, r.row_x.z, t.x},
                              {r.row_y.x, r.row_y.y, r.row_y.z, t.y},
                              {r.row_z.x, r.row_z.y, r.row_z.z, t.z},
                              {0.0, 0.0, 0.0, 1.0}});
}

void step(Simulation& simulation, std::size_t count) {
  constexpr std::size_t kStepsPerSignalCheck = 16;
  while (count > 0) {
    const std::size_t batch = std::min(count, kStepsPerSignalCheck);
    {
      const nb::gil_scoped_release released;
      for (std::size_t i = 0; i < batch; ++i) simulation.step();
    }
    count -= batch;
    if (PyErr_CheckSignals() != 0) throw nb::python_error();
  }
}

/// Each step's seconds: whole step, narrow phase, and its query, reduction and manifold parts.
nb::ndarray<nb::numpy, double> timings(const Simulation& simulation) {
  std::vector<std::array<double, 5>> rows;
  rows.reserve(simulation.timings().size());
  for (const StepTimings& t : simulation.timings()) {
    rows.push_back({t.step, t.narrow_phase, t.query, t.reduction, t.manifold});
  }
  return to_array(std::move(rows));
}

/// Rows of body a, body b, id, point on a, point on b, normal, depth, impulse.
nb::ndarray<nb::numpy, double> contacts(const Simulation& simulation) {
  std::vector<std::array<double, 14>> rows;
  for (const SimulationContact& c : simulation.compute_contacts()) {
    rows.push_back({static_cast<double>(c.body_a), static_cast<double>(c.body_b),
                    static_cast<double>(c.id), c.point_a.x, c.point_a.y, c.point_a.z, c.point_b.x,
                    c.point_b.y, c.point_b.z, c.normal.x, c.normal.y, c.normal.z, c.depth,
                    c.impulse});
  }
  return to_array(std::move(rows));
}

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
  nb::class_<GImpactGeometry>(module, "GImpactGeometry")
      .def("__init__", [](GImpactGeometry* self, const PointsArray& vertices,
                          const FacesArray& faces, double margin) {
        new (self) GImpactGeometry{to_points(vertices), to_triangles(faces), margin};
      });
  nb::class_<HullsGeometry>(module, "HullsGeometry")
      .def("__init__",
           [](HullsGeometry* self, const std::vector<PointsArray>& hulls, double margin) {
             std::vector<std::vector<Vec3>> points;
             for (const PointsArray& hull : hulls) points.push_back(to_points(hull));
             new (self) HullsGeometry{std::move(points), margin};
           });
  module.def(
      "triangulate_hulls",
      [](const std::vector<PointsArray>& hulls) {
        std::vector<std::vector<Vec3>> points;
        for (const PointsArray& hull : hulls) points.push_back(to_points(hull));
        const HullMesh mesh = triangulate_hulls(points);
        std::vector<std::array<double, 3>> vertices;
        for (const Vec3& p : mesh.vertices) vertices.push_back({p.x, p.y, p.z});
        return std::pair(to_array(vertices), to_array(mesh.triangles));
      },
      nb::arg("hulls"), "Vertices (n, 3) and triangles (m, 3) of the hulls of sets of points.");
  module.def(
      "mesh_mass_properties",
      [](const PointsArray& vertices, const FacesArray& faces, const std::string& kind) {
        const auto mesh = unwrap(TriangleMesh::create(to_points(vertices), to_triangles(faces)));
        const MassProperties m = kind == "surface" ? compute_surface_mass_properties(mesh)
                                                   : compute_solid_mass_properties(mesh);
        return std::pair(
            to_coordinates(m.centre_of_mass),
            std::array{to_coordinates(m.inertia.row_x), to_coordinates(m.inertia.row_y),
                       to_coordinates(m.inertia.row_z)});
      },
      nb::arg("vertices"), nb::arg("faces"), nb::arg("kind"),
      "Centre of mass and inertia tensor about it at 1 kg, of kind 'solid' or 'surface'.");
  module.def(
      "sample_hull",
      [](const PointsArray& points) {
        std::vector<std::array<double, 3>> rows;
        for (const Vec3& p : sample_hull(to_points(points))) rows.push_back({p.x, p.y, p.z});
        return to_array(std::move(rows));
      },
      nb::arg("points"), "Vertices of the hull in the 42 directions of btShapeHull, (n, 3).");
}

void bind_simulation(nb::module_& module) {
  nb::enum_<bullet::ContactMode>(module, "ContactMode")
      .value("AUTO", bullet::ContactMode::kAutomatic)
      .value("REGULAR", bullet::ContactMode::kRegular)
      .value("SEGMENTED", bullet::ContactMode::kSegmented);

  nb::enum_<ConstraintSolver>(module, "ConstraintSolver")
      .value("SEQUENTIAL_IMPULSE", ConstraintSolver::kSequentialImpulse)
      .value("NNCG", ConstraintSolver::kNncg)
      .value("DANTZIG", ConstraintSolver::kDantzig)
      .value("PROJECTED_GAUSS_SEIDEL", ConstraintSolver::kProjectedGaussSeidel);

  nb::class_<Simulation>(module, "Simulation")
      .def(
          "__init__",
          [](Simulation* self, const Coordinates& gravity, double time_step, bool sleeping,
             double split_impulse_threshold, ConstraintSolver solver, int iterations,
             bullet::ContactMode mode, int level, double margin, double sweep_beyond) {
            new (self)
                Simulation({.gravity = to_vec3(gravity),
                            .time_step = time_step,
                            .sleeping = sleeping,
                            .split_impulse_threshold = split_impulse_threshold,
                            .solver = solver,
                            .iterations = iterations,
                            .contact = {.mode = mode,
                                        .level = level,
                                        .margin = margin,
                                        .sweep_beyond = sweep_beyond,
                                        .rolling_at_rest = solver != ConstraintSolver::kNncg}});
          },
          nb::arg("gravity"), nb::arg("time_step"), nb::arg("sleeping"),
          nb::arg("split_impulse_threshold"), nb::arg("solver"), nb::arg("iterations"),
          nb::arg("mode"), nb::arg("level"), nb::arg("margin"), nb::arg("sweep_beyond"))
      .def(
          "add_body",
          [](Simulation& self, const Geometry& geometry, double mass,
             const Coordinates& centre_of_mass, const std::array<Coordinates, 3>& inertia,
             const PoseArray& pose, double friction, double restitution) {
            return self.add_body({.geometry = geometry,
                                  .mass_properties = {mass,
                                                      to_vec3(centre_of_mass),
                                                      {to_vec3(inertia[0]), to_vec3(inertia[1]),
                                                       to_vec3(inertia[2])}},
                                  .world_from_geometry = to_pose(pose),
                                  .friction = friction,
                                  .restitution = restitution});
          },
          nb::arg("geometry"), nb::arg("mass"), nb::arg("centre_of_mass"), nb::arg("inertia"),
          nb::arg("pose"), nb::arg("friction"), nb::arg("restitution"))
      .def("step", &step, nb::arg("count"))
      .def("timings", &timings)
      .def("clear_timings", &Simulation::clear_timings)
      .def("contacts", &contacts)
      .def("pose",
           [](const Simulation& s, std::size_t i) { return to_matrix(s.world_from_geometry(i)); })
      .def("set_pose", [](Simulation& s, std::size_t i,
                          const PoseArray& pose) { s.set_world_from_geometry(i, to_pose(pose)); })
      .def("linear_velocity",
           [](const Simulation& s, std::size_t i) { return to_coordinates(s.linear_velocity(i)); })
      .def("angular_velocity",
           [](const Simulation& s, std::size_t i) { return to_coordinates(s.angular_velocity(i)); })
      .def("set_linear_velocity",
           [](Simulation& s, std::size_t i, const Coordinates& v) {
             s.set_linear_velocity(i, to_vec3(v));
           })
      .def("set_angular_velocity",
           [](Simulation& s, std::size_t i, const Coordinates& v) {
             s.set_angular_velocity(i, to_vec3(v));
           })
      .def("is_asleep", &Simulation::is_asleep);
}

}  // namespace
}  // namespace voxshell::python

NB_MODULE(_bullet, module) {
  module.doc() = "Stock Bullet with voxshell's models. Use it through voxshell.World.";
  voxshell::python::bind_geometries(module);
  voxshell::python::bind_simulation(module);
  module.attr("most_timings") = voxshell::python::Simulation::kMostTimings;
  module.attr("bullet_version") = btGetVersion();
}
