#include <array>
#include <cstddef>
#include <memory>
#include <span>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include <nanobind/stl/array.h>
#include <nanobind/stl/shared_ptr.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/tuple.h>

#include "arrays.h"
#include "build_watch.h"
#include "core_module.h"
#include "errors.h"
#include "in_ordinary_floats.h"
#include "interpreter_lock.h"
#include "voxshell/model.h"
#include "voxshell/model_file.h"

namespace nb = nanobind;

namespace voxshell::python {
namespace {

std::shared_ptr<const Model> build(const PointsArray& vertices, const FacesArray& faces,
                                   double tolerance, double voxel_size, int resolution,
                                   double point_spacing, std::size_t target_points, double padding,
                                   const std::string& sign, const std::string& open,
                                   double sheet_thickness, unsigned threads, nb::handle progress) {
  const std::vector<Vec3> corners = read_points(vertices);
  const std::vector<Triangle> triangles = read_triangles(faces);

  const ModelSettings settings{.tolerance = tolerance,
                               .voxel_size = voxel_size,
                               .resolution = resolution,
                               .point_spacing = point_spacing,
                               .target_points = target_points,
                               .padding = padding,
                               .sign = sign == "closed"    ? SignMethod::kClosed
                                       : sign == "winding" ? SignMethod::kWinding
                                                           : SignMethod::kAutomatic,
                               .open = open == "solid"   ? OpenMesh::kSolid
                                       : open == "sheet" ? OpenMesh::kSheet
                                                         : OpenMesh::kAutomatic,
                               .sheet_thickness = sheet_thickness,
                               .threads = threads};
  BuildWatch watch(progress);
  auto result = [&]() -> Result<std::shared_ptr<const Model>> {
    const ReleasedInterpreter released;
    auto mesh = TriangleMesh::create(corners, triangles);
    if (!mesh) return mesh.error();
    return Model::build(*std::move(mesh), settings, [&](std::string_view stage, double fraction) {
      return watch.report(stage, fraction);
    });
  }();
  watch.rethrow();
  return unwrap(std::move(result));
}

/// A file name in the system's encoding, which may be any bytes.
std::string read_path(const nb::bytes& path) { return {path.c_str(), path.size()}; }

void save(const Model& model, const nb::bytes& path) {
  const std::string name = read_path(path);
  unwrap([&] {
    const ReleasedInterpreter released;
    return save_model(model, name);
  }());
}

std::shared_ptr<const Model> load(const nb::bytes& path) {
  const std::string name = read_path(path);
  return unwrap([&] {
    const ReleasedInterpreter released;
    return load_model(name);
  }());
}

nb::bytes to_bytes(const Model& model) {
  const auto content = [&] {
    const ReleasedInterpreter released;
    return model_to_bytes(model);
  }();
  return nb::bytes(content.data(), content.size());
}

std::shared_ptr<const Model> from_bytes(const nb::bytes& content) {
  const std::span bytes(reinterpret_cast<const std::byte*>(content.c_str()), content.size());
  return unwrap([&] {
    const ReleasedInterpreter released;
    return model_from_bytes(bytes);
  }());
}

using Coordinates = std::array<double, 3>;

Coordinates to_coordinates(const Vec3& v) { return {v.x, v.y, v.z}; }

/// Center of mass and inertia tensor at 1 kg.
std::tuple<Coordinates, std::array<Coordinates, 3>> to_tuple(const MassProperties& m) {
  return {to_coordinates(m.center_of_mass),
          {to_coordinates(m.inertia.row_x), to_coordinates(m.inertia.row_y),
           to_coordinates(m.inertia.row_z)}};
}

}  // namespace

void bind_model(nb::module_& module) {
  using SharedModel = std::shared_ptr<const Model>;
  nb::class_<Model>(module, "Model", "Field, shell and mass properties of a mesh.")
      .def_static(
          "build", &build, nb::arg("vertices"), nb::arg("faces"), nb::kw_only(),
          nb::arg("tolerance"), nb::arg("voxel_size"), nb::arg("resolution"),
          nb::arg("point_spacing"), nb::arg("target_points"), nb::arg("padding"), nb::arg("sign"),
          nb::arg("open"), nb::arg("sheet_thickness"), nb::arg("threads"),
          nb::arg("progress").none(), InOrdinaryFloats(),
          nb::sig("def build(vertices: numpy.typing.NDArray[numpy.float64], faces: "
                  "numpy.typing.NDArray[numpy.uint32], *, tolerance: float, voxel_size: float, "
                  "resolution: "
                  "int, point_spacing: float, target_points: int, padding: float, "
                  "sign: str, open: str, sheet_thickness: float, threads: int, progress: "
                  "collections.abc.Callable[[str, float], object] "
                  "| None) -> Model"),
          "Build a model. With 0 (padding: below 0) the core chooses a setting.")
      .def("save", &save, nb::arg("path"), InOrdinaryFloats())
      .def_static("load", &load, nb::arg("path"), InOrdinaryFloats())
      .def("to_bytes", &to_bytes, InOrdinaryFloats(), "Return the bytes that `save` writes.")
      .def_static("from_bytes", &from_bytes, nb::arg("content"), InOrdinaryFloats())
      .def_prop_ro("vertices",
                   [](const Model& m) { return view_rows<double, 3>(m.mesh().vertices()); })
      .def_prop_ro("faces",
                   [](const Model& m) { return view_rows<std::uint32_t, 3>(m.mesh().triangles()); })
      .def_prop_ro("bounds",
                   [](const Model& m) {
                     return std::array{to_coordinates(m.bounds().lower),
                                       to_coordinates(m.bounds().upper)};
                   })
      .def_prop_ro(
          "field",
          [](const SharedModel& m) { return std::shared_ptr<const Field>(m, &m->field()); })
      .def_prop_ro(
          "grid",
          [](const SharedModel& m) { return std::shared_ptr<const GridField>(m, &m->grid()); })
      .def_prop_ro(
          "shell",
          [](const SharedModel& m) { return std::shared_ptr<const PointShell>(m, &m->shell()); })
      .def_prop_ro(
          "accuracy",
          [](const Model& m) {
            const Accuracy& a = m.accuracy();
            const auto of = [](const ErrorStatistic& s) {
              return std::array{s.median, s.p99, s.worst};
            };
            return std::tuple{a.places, of(a.distance), of(a.normal), of(a.coverage),
                              a.gap,    a.is_sharp,     a.curvature};
          },
          "Number of places; median, 99 % and worst of distance, normal and coverage; gap; "
          "is_sharp; curvature.")
      .def_prop_ro(
          "openings",
          [](const Model& m) {
            const Openings& o = m.openings();
            return std::tuple{o.loops,
                              o.fraction,
                              o.mouths,
                              o.largest_diameter,
                              to_coordinates(o.first_location),
                              o.sheet_thickness};
          },
          "Loops, fraction, mouths, largest diameter, first location, and the sheet's thickness or "
          "0.")
      .def_prop_ro(
          "tolerance", [](const Model& m) { return m.settings().tolerance; },
          "Meters; 0 if the model is uniform.")
      .def_prop_ro("thickness", &Model::thickness, "Thickness of the thinnest walls, meters.")
      .def_prop_ro(
          "solid_mass_properties",
          [](const Model& m) { return to_tuple(m.solid_mass_properties()); },
          "Center of mass and inertia tensor about it, at 1 kg.")
      .def_prop_ro(
          "surface_mass_properties",
          [](const Model& m) { return to_tuple(m.surface_mass_properties()); },
          "Center of mass and inertia tensor about it, at 1 kg.");
}

}  // namespace voxshell::python
