#include "voxshell/model.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/text.h"
#include "field/brick_grid.h"
#include "field/build_grid_field.h"
#include "field/choose_voxels.h"
#include "mesh/openings.h"
#include "mesh/repair.h"
#include "mesh/thicken.h"
#include "mesh/thickness.h"
#include "model/measure_accuracy.h"

namespace voxshell {
namespace {

constexpr int kDefaultResolution = 100;

/// The tolerance where nothing is given. Of two models less than five of the larger tolerance is
/// missed (1.4 by a field, one by either shell, and what of smooth bodies enters between the points
/// of both), which is no more than a millimeter, or of bodies above 4 m a 4,000th. Walls keep their
/// shape where they are thinnest.
constexpr double kToleranceOfSide = 1.0 / 2000.0;
constexpr double kToleranceOfLargeSide = 1.0 / 20000.0;
constexpr double kLargeTolerance = 0.0002;  // meters
constexpr double kToleranceOfThickness = 1.0 / 20.0;

Error invalid_argument(std::string message) {
  return {ErrorCode::kInvalidArgument, std::move(message)};
}

double longest_side(const TriangleMesh& mesh) {
  return mesh.bounds().extents()[mesh.bounds().longest_axis()];
}

/// A size above the mesh's own is one in another unit.
Result<std::monostate> check_unit(const char* name, double size, const TriangleMesh& mesh) {
  if (!(size > longest_side(mesh)) || std::isinf(size)) return std::monostate{};
  return Error{ErrorCode::kInvalidMesh,
               format_text("mesh has a longest side of %.6g m, below the %s of %.6g m: check their "
                           "units (a scale of 0.001 brings a mesh from millimeters to meters)",
                           longest_side(mesh), name, size)};
}

bool is_uniform(const ModelSettings& settings) {
  return settings.voxel_size != 0.0 || settings.resolution != 0 || settings.point_spacing != 0.0 ||
         settings.target_points != 0;
}

/// 0 for a uniform model.
Result<double> choose_tolerance(const TriangleMesh& mesh, const ModelSettings& settings,
                                double thickness) {
  if (settings.tolerance != 0.0) {
    if (is_uniform(settings)) {
      return invalid_argument(
          "give either a tolerance or the sizes of a uniform model (voxel size, resolution, point "
          "spacing, target points), not both");
    }
    if (settings.tolerance > 0.0 && std::isfinite(settings.tolerance)) return settings.tolerance;
    return invalid_argument(format_text("tolerance must be above 0 m, not %g", settings.tolerance));
  }
  if (is_uniform(settings)) return 0.0;
  const double side = longest_side(mesh);
  const double by_side =
      std::min(kToleranceOfSide * side, std::max(kLargeTolerance, kToleranceOfLargeSide * side));
  return thickness > 0.0 ? std::min(by_side, kToleranceOfThickness * thickness) : by_side;
}

Result<double> choose_voxel_size(const TriangleMesh& mesh, const ModelSettings& settings) {
  if (settings.voxel_size != 0.0 && settings.resolution != 0) {
    return invalid_argument("give either a voxel size or a resolution, not both");
  }
  if (settings.voxel_size != 0.0) {
    if (settings.voxel_size > 0.0 && std::isfinite(settings.voxel_size)) return settings.voxel_size;
    return invalid_argument(
        format_text("voxel size must be above 0 m, not %g", settings.voxel_size));
  }
  const int resolution = settings.resolution == 0 ? kDefaultResolution : settings.resolution;
  if (resolution < 2) {
    return invalid_argument(format_text(
        "resolution must be at least 2 voxels along the longest side, not %d", resolution));
  }
  return longest_side(mesh) / resolution;
}

/// Steps of float32 between a power of two and the next one.
constexpr double kFloatSteps = 1 << 23;

/// The largest coordinate, meters.
double reach(const TriangleMesh& mesh) {
  const Bounds& bounds = mesh.bounds();
  double farthest = 0.0;
  for (int axis = 0; axis < 3; ++axis) {
    farthest = std::max({farthest, std::abs(bounds.lower[axis]), std::abs(bounds.upper[axis])});
  }
  return farthest;
}

/// Points and samples are float32 in the mesh's frame: its origin must not be too far away.
Result<std::monostate> check_precision(const TriangleMesh& mesh, double voxel_size) {
  constexpr double kLargestUlp = 1e-3;  // voxels
  const double farthest = reach(mesh);
  const double ulp = farthest / kFloatSteps;
  if (ulp <= kLargestUlp * voxel_size) return std::monostate{};
  const double advised = 1.02 * ulp / kLargestUlp;
  const bool has_coarser = advised < longest_side(mesh);
  return Error{
      ErrorCode::kInvalidMesh,
      format_text("mesh reaches %.3g m from its origin, too far for voxels of %.3g m in "
                  "single precision; check its unit%s move it to its origin (put the offset "
                  "in the pose)",
                  farthest, voxel_size, has_coarser ? "," : ", or") +
          (has_coarser ? format_text(", or use a voxel size of at least %.3g m", advised) : "")};
}

/// Points that single precision moves by more than a tolerance cannot keep it.
Result<std::monostate> check_tolerance(const TriangleMesh& mesh, double tolerance) {
  const double farthest = reach(mesh);
  const double ulp = farthest / kFloatSteps;
  if (ulp <= tolerance) return std::monostate{};
  return Error{ErrorCode::kInvalidMesh,
               format_text("mesh reaches %.3g m from its origin, too far for a tolerance of %.3g m "
                           "in single precision; check its unit, move it to its origin (put the "
                           "offset in the pose), or use a tolerance of at least %.3g m",
                           farthest, tolerance, 1.02 * ulp)};
}

/// Meters. Sheets thinner than two voxels of a uniform grid would have no inside.
Result<double> choose_sheet_thickness(const TriangleMesh& mesh, const ModelSettings& settings) {
  const double longest = longest_side(mesh);
  if (settings.sheet_thickness != 0.0) {
    if (settings.sheet_thickness > 0.0 && settings.sheet_thickness < longest) {
      return settings.sheet_thickness;
    }
    return invalid_argument(format_text(
        "sheet thickness must be above 0 m and below the mesh's longest side of %.6g m, not %g",
        longest, settings.sheet_thickness));
  }
  constexpr double kFraction = 1.0 / 200.0;
  constexpr double kVoxels = 2.0;
  if (!is_uniform(settings)) return kFraction * longest;
  const auto voxel_size = choose_voxel_size(mesh, settings);
  if (!voxel_size) return voxel_size.error();
  return std::max(kFraction * longest, kVoxels * *voxel_size);
}

/// Makes a sheet of the mesh where it is to be one.
Result<Openings> close_mesh(RepairedMesh& repaired, const ModelSettings& settings) {
  const TriangleMesh& mesh = repaired.mesh;
  Openings openings = find_openings(mesh);
  const bool decides = settings.open == OpenMesh::kAutomatic &&
                       settings.sign == SignMethod::kAutomatic && suggest_sheet(openings) &&
                       mesh.compute_defects().open_edges > 0;  // none where faces are doubled
  if (openings.loops == 0 || !(decides || settings.open == OpenMesh::kSheet)) return openings;
  const auto thickness = choose_sheet_thickness(mesh, settings);
  if (!thickness) return thickness.error();
  auto solid = thicken(mesh, *thickness);
  if (!solid) return solid.error();
  const MeshDefects found = repaired.found;
  repaired = take_as_it_is(*std::move(solid));
  repaired.found = found;
  openings.sheet_thickness = *thickness;
  return openings;
}

/// The inside of a mesh that is not closed is that of its field, to a 64th of its longest side.
MassProperties compute_solid(const TriangleMesh& mesh, const GridField& field) {
  if (field.sign_report().method == SignMethod::kClosed) return compute_solid_mass_properties(mesh);
  constexpr int kPieces = 64;
  const Bounds& bounds = mesh.bounds();
  const Vec3 extents = bounds.extents();
  const double piece = extents[bounds.longest_axis()] / kPieces;
  const auto pieces = [&](int axis) { return static_cast<int>(std::ceil(extents[axis] / piece)); };
  std::size_t count = 0;
  Vec3 sum{};
  Vec3 squares{};
  Vec3 products{};  // y z, z x, x y
  for (int k = 0; k < pieces(2); ++k) {
    for (int j = 0; j < pieces(1); ++j) {
      for (int i = 0; i < pieces(0); ++i) {
        const Vec3 p = piece * Vec3{i + 0.5, j + 0.5, k + 0.5};
        if (field.distance(static_cast<Vec3f>(bounds.lower + p)) >= 0.0f) continue;
        ++count;
        sum += p;
        squares += {p.x * p.x, p.y * p.y, p.z * p.z};
        products += {p.y * p.z, p.z * p.x, p.x * p.y};
      }
    }
  }
  if (count == 0) return compute_surface_mass_properties(mesh);
  const double fraction = 1.0 / static_cast<double>(count);
  const Vec3 c = fraction * sum;
  const double own = piece * piece / 12.0;
  const Vec3 s = fraction * squares - Vec3{c.x * c.x, c.y * c.y, c.z * c.z} + Vec3{own, own, own};
  const Vec3 m = fraction * products - Vec3{c.y * c.z, c.z * c.x, c.x * c.y};
  return {1.0,
          bounds.lower + c,
          {{s.y + s.z, -m.z, -m.y}, {-m.z, s.x + s.z, -m.x}, {-m.y, -m.x, s.x + s.y}}};
}

}  // namespace

Model::Model(TriangleMesh mesh, GridField field, PointShell shell, const ModelSettings& settings,
             const Accuracy& accuracy, double thickness, const Openings& openings)
    : mesh_(std::move(mesh)),
      field_(std::move(field)),
      shell_(std::move(shell)),
      solid_(compute_solid(mesh_, grid())),
      surface_(compute_surface_mass_properties(mesh_)),
      settings_(settings),
      accuracy_(accuracy),
      thickness_(thickness),
      openings_(openings) {}

const SmoothSurface& Model::smooth_surface() const {
  std::call_once(smooth_surface_once_,
                 [&] { smooth_surface_ = std::make_unique<const SmoothSurface>(mesh_, shell_); });
  return *smooth_surface_;
}

Result<std::shared_ptr<const Model>> Model::build(TriangleMesh mesh, const ModelSettings& settings,
                                                  const Progress& progress) {
  RepairedMesh repaired =
      settings.sign == SignMethod::kClosed ? take_as_it_is(std::move(mesh)) : repair_mesh(mesh);
  const auto opened = close_mesh(repaired, settings);
  if (!opened) return opened.error();
  const Openings openings = *opened;
  const double thickness = compute_thickness(repaired.mesh);
  const auto tolerance = choose_tolerance(repaired.mesh, settings, thickness);
  if (!tolerance) return tolerance.error();
  if (settings.tolerance > 0.0) {
    if (auto precise = check_tolerance(repaired.mesh, *tolerance); !precise) return precise.error();
  }
  const auto voxel_size = *tolerance > 0.0
                              ? choose_voxels(repaired.mesh, *tolerance, settings.threads)
                              : choose_voxel_size(repaired.mesh, settings);
  if (!voxel_size) return voxel_size.error();
  if (auto unit = check_unit("voxel size", *voxel_size, repaired.mesh); !unit) return unit.error();
  if (auto unit = check_unit("point spacing", settings.point_spacing, repaired.mesh); !unit) {
    return unit.error();
  }
  if (auto precise = check_precision(repaired.mesh, *voxel_size); !precise) return precise.error();

  PointShellSettings shell_settings{.tolerance = *tolerance,
                                    .wall_thickness = thickness,
                                    .spacing = settings.point_spacing,
                                    .target_points = settings.target_points,
                                    .threads = settings.threads};
  const bool as_voxels =
      *tolerance == 0.0 && shell_settings.spacing == 0.0 && shell_settings.target_points == 0;
  if (as_voxels) shell_settings.spacing = *voxel_size;

  // Two bricks: over a flat face clusters of some size then lie in bricks of its plane alone.
  constexpr double kDefaultPaddingVoxels = 16.0;
  const double padding =
      settings.padding < 0.0 ? kDefaultPaddingVoxels * *voxel_size : settings.padding;
  const GridFieldSettings field_settings{.voxel_size = *voxel_size,
                                         .tolerance = *tolerance,
                                         .wall_thickness = thickness,
                                         .padding = padding,
                                         .sign = settings.sign,
                                         .threads = settings.threads};
  if (auto checked = PointShell::check(repaired.mesh, shell_settings); !checked) {
    // First what is mostly above its limit too, and asks for the larger voxels.
    if (auto plan = plan_brick_grid(repaired.mesh, field_settings); !plan) return plan.error();
    Error error = checked.error();
    if (as_voxels) error.message += " (it is the voxel size where none is given)";
    return error;
  }
  auto built = build_grid_field(repaired, field_settings, progress);
  if (!built) return built.error();
  auto& [field, of_visible] = *built;
  if (field.sign_report().was_turned) repaired.mesh = repaired.mesh.turned();
  const VisibleSurface* visible = of_visible ? &*of_visible : nullptr;
  auto shell = PointShell::build(repaired.mesh, visible, shell_settings, progress);
  if (!shell) return shell.error();

  const Accuracy accuracy = measure_accuracy(
      repaired.mesh, field, *shell,
      {.thickness = thickness, .tolerance = *tolerance, .threads = settings.threads}, visible);
  ModelSettings chosen = settings;
  chosen.tolerance = *tolerance;
  return std::shared_ptr<const Model>(new Model(std::move(repaired.mesh), std::move(field),
                                                *std::move(shell), chosen, accuracy, thickness,
                                                openings));
}

Result<std::shared_ptr<const Model>> Model::from_parts(TriangleMesh mesh, GridField field,
                                                       PointShell shell,
                                                       const ModelSettings& settings,
                                                       const Accuracy& accuracy, double thickness,
                                                       const Openings& openings) {
  const auto refuse = [](const char* why) { return Error{ErrorCode::kInvalidArgument, why}; };
  const Bounds& bounds = mesh.bounds();
  if (field.surface_bounds().lower != bounds.lower ||
      field.surface_bounds().upper != bounds.upper) {
    return refuse("the field is of a mesh with other bounds");
  }
  Bounds of_points;
  for (const Vec3f& p : shell.points()) of_points.extend(static_cast<Vec3>(p));
  if (const EdgeSegments* edges = shell.edges(); edges != nullptr) {
    for (std::size_t i = 0; i < edges->size(); ++i) {
      const auto middle = static_cast<Vec3>(edges->middles()[i]);
      const auto half = static_cast<Vec3>(edges->halves()[i]);
      of_points.extend(middle - half);
      of_points.extend(middle + half);
    }
  }
  for (int axis = 0; axis < 3; ++axis) {
    constexpr double kRounding = 1e-6;  // of float32, several times
    const double slack =
        kRounding * std::max(std::abs(bounds.lower[axis]), std::abs(bounds.upper[axis]));
    if (of_points.lower[axis] < bounds.lower[axis] - slack ||
        of_points.upper[axis] > bounds.upper[axis] + slack) {
      return refuse("points or edges of the shell lie outside the mesh's bounds");
    }
  }
  std::shared_ptr<const Model> model(new Model(std::move(mesh), std::move(field), std::move(shell),
                                               settings, accuracy, thickness, openings));
  for (const MassProperties& m : {model->solid_, model->surface_}) {
    const auto& [x, y, z] = m.inertia;
    if (!is_finite(m.center_of_mass + x + y + z)) return refuse("the mesh has no mass properties");
  }
  return model;
}

}  // namespace voxshell
