#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string_view>
#include <utility>
#include <vector>

#include "base/text.h"
#include "field/brick_grid.h"
#include "field/build_grid_field.h"
#include "field/enclosing_surface.h"
#include "field/field_builder.h"
#include "field/inside.h"
#include "mesh/row_winding.h"
#include "voxshell/grid_field.h"

namespace voxshell {
namespace {

using simd::kBrickCells;

/// A mesh is refused where less of its area than this has a clear inside and outside.
constexpr double kLeastConfidence = 0.5;

GridFieldData begin_data(const TriangleMesh& mesh, const BrickGrid& grid) {
  GridFieldData data;
  data.voxel_size = grid.voxel_size;
  data.origin = grid.origin;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    data.bricks[axis] = static_cast<int>(grid.bricks[axis]);
  }
  data.surface_bounds = mesh.bounds();
  return data;
}

Result<GridFieldData> build_closed(const TriangleMesh& mesh, const BrickGridPlan& plan,
                                   const GridFieldSettings& settings, SignReport& report,
                                   const Progress& progress) {
  if (auto closed = check_encloses_volume(mesh); !closed) return closed.error();
  const BrickGrid& grid = plan.grid;
  const auto winding = RowWinding::build(mesh, {.origin = grid.origin,
                                                .step = grid.voxel_size,
                                                .rows_y = kBrickCells * grid.bricks[1] + 1,
                                                .rows_z = kBrickCells * grid.bricks[2] + 1});
  if (!winding) return winding.error();
  const InsideByRows inside(grid, *winding);
  FieldBuilder builder(mesh, plan, settings, inside, progress,
                       settings.tolerance > 0.0 ? compute_features(mesh) : Features{});
  GridFieldData data = begin_data(mesh, grid);
  if (auto stopped = builder.build(data)) {
    report.overlaps = builder.overlap().places;
    if (report.overlaps > 0) report.first_location = builder.overlap().first;
    return *std::move(stopped);
  }
  report.method = SignMethod::kClosed;
  return data;
}

/// `visible` becomes what of the mesh bounds the body, where that is not all of it. `is_balanced`
/// says that the mesh has no openings.
Result<GridFieldData> build_by_winding(const TriangleMesh& mesh, bool is_balanced,
                                       const std::shared_ptr<const SurfaceCutter>& cutter,
                                       const BrickGridPlan& plan, const GridFieldSettings& settings,
                                       SignReport& report, std::optional<VisibleSurface>& visible,
                                       const Progress& progress) {
  const Error no_volume{
      ErrorCode::kInvalidMesh,
      format_text("mesh encloses no volume: its winding number is above a half nowhere on the grid "
                  "(%zu open, %zu non-manifold and %zu wrongly oriented edges, first near %s "
                  "metres); repair it, or give it a thickness",
                  report.defects.open_edges, report.defects.non_manifold_edges,
                  report.defects.flipped_edges,
                  format_point(report.defects.first_location).c_str())};
  const Error cancelled{ErrorCode::kCancelled, "building the distance field was stopped"};
  const BrickGrid& grid = plan.grid;
  const InsideByWindingNumbers inside(grid, mesh.bounds(), *cutter);
  bool was_stopped = false;
  const Progress watched = [&](std::string_view stage, double /*fraction*/) {
    was_stopped = was_stopped || (progress && !progress(stage, 0.0));
    return !was_stopped;
  };
  auto surface = find_enclosing_surface(mesh, cutter, grid, inside, kLeastConfidence,
                                        settings.threads, watched);
  if (!surface) return was_stopped ? cancelled : no_volume;
  report.confidence = surface->confidence;
  if (report.confidence < kLeastConfidence) {
    return Error{
        ErrorCode::kInvalidMesh,
        format_text("it is in doubt what the mesh has inside: on %.0f %% of its area it has "
                    "a winding number near a half on one of its sides (%zu open, %zu "
                    "non-manifold and %zu wrongly oriented edges, first near %s metres); "
                    "repair it, or give it a thickness",
                    100.0 * (1.0 - report.confidence), report.defects.open_edges,
                    report.defects.non_manifold_edges, report.defects.flipped_edges,
                    format_point(report.defects.first_location).c_str())};
  }
  // In a cell that the limit of the inside cuts it crosses an edge.
  report.cap_error = surface->caps > 0 ? std::sqrt(3.0) * grid.voxel_size : 0.0;
  const BrickGridPlan of_surface{grid, find_least_cells(surface->mesh, grid)};
  // Only of closed surfaces do the normals of edges and corners tell inside from outside.
  GridFieldSettings of_field = settings;
  if (!is_balanced || surface->caps > 0) of_field.tolerance = 0.0;
  Features features;
  if (of_field.tolerance > 0.0) {
    features =
        surface->visible ? compute_features(mesh, *surface->visible) : compute_features(mesh);
  }
  FieldBuilder builder(surface->mesh, of_surface, of_field, inside, progress, std::move(features));
  GridFieldData data = begin_data(mesh, grid);
  data.sign = report;
  if (auto stopped = builder.build(data)) return *std::move(stopped);
  if (builder.overlap().inside == 0) return no_volume;
  report.method = SignMethod::kWinding;
  report.hidden_triangles = surface->hidden_triangles;
  if (report.overlaps == 0 && report.defects.is_closed()) {
    report.first_location = surface->first_hidden;
  }
  visible = std::move(surface->visible);
  return data;
}

}  // namespace

Result<BuiltField> build_grid_field(const RepairedMesh& repaired, const GridFieldSettings& settings,
                                    const Progress& whole_progress) {
  const auto plan = plan_brick_grid(repaired.mesh, settings);
  if (!plan) return plan.error();
  // Where a mesh turns out not to be what it was taken for, the work begins again.
  double reported = 0.0;
  Progress progress;
  if (whole_progress) {
    progress = [&](std::string_view stage, double fraction) {
      reported = std::max(reported, fraction);
      return whole_progress(stage, reported);
    };
  }
  SignReport report;
  std::shared_ptr<const SurfaceCutter> cutter;
  std::optional<VisibleSurface> visible;
  const auto finish = [&](Result<GridFieldData> data) -> Result<BuiltField> {
    if (!data) return data.error();
    data->sign = report;
    return BuiltField{GridField(*std::move(data)), std::move(visible)};
  };
  if (settings.sign == SignMethod::kClosed) {
    return finish(build_closed(repaired.mesh, *plan, settings, report, progress));
  }
  report.defects = repaired.found;
  report.first_location = report.defects.first_location;
  report.was_turned = repaired.mesh.compute_volume() < 0.0;
  const std::optional<TriangleMesh> turned =
      report.was_turned ? std::optional(repaired.mesh.turned()) : std::nullopt;
  const TriangleMesh& mesh = turned ? *turned : repaired.mesh;
  if (settings.sign == SignMethod::kAutomatic && repaired.is_closed) {
    auto closed = build_closed(mesh, *plan, settings, report, progress);
    if (!closed && closed.error().code != ErrorCode::kInvalidMesh) return closed.error();
    if (closed) {
      // Parts may touch, or overlap by less than nodes show.
      const std::vector<std::uint32_t> suspects = find_suspects(mesh);
      if (suspects.empty()) return finish(std::move(closed));
      cutter = std::make_shared<const SurfaceCutter>(mesh);
      if (!cutter->hides_any(suspects, settings.threads)) return finish(std::move(closed));
    }
  }
  if (!cutter) cutter = std::make_shared<const SurfaceCutter>(mesh);
  return finish(build_by_winding(mesh, repaired.is_balanced, cutter, *plan, settings, report,
                                 visible, progress));
}

Result<GridField> GridField::build(const TriangleMesh& mesh, const GridFieldSettings& settings,
                                   const Progress& progress) {
  auto built = build_grid_field(
      settings.sign == SignMethod::kClosed ? take_as_it_is(mesh) : repair_mesh(mesh), settings,
      progress);
  if (!built) return built.error();
  return std::move(built->field);
}

}  // namespace voxshell
