#include <algorithm>
#include <cmath>
#include <cstddef>
#include <string_view>
#include <utility>

#include "base/text.h"
#include "field/brick_grid.h"
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
  FieldBuilder builder(mesh, plan, settings, inside, progress);
  GridFieldData data = begin_data(mesh, grid);
  if (auto stopped = builder.build(data)) {
    report.overlaps = builder.overlap().places;
    if (report.overlaps > 0) report.first_location = builder.overlap().first;
    return *std::move(stopped);
  }
  report.method = SignMethod::kClosed;
  return data;
}

Result<GridFieldData> build_by_winding(const TriangleMesh& mesh, const BrickGridPlan& plan,
                                       const GridFieldSettings& settings, SignReport& report,
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
  const WindingNumberTree winding(mesh);
  const InsideByWindingNumbers inside(grid, mesh.bounds(), winding, report.was_turned ? -1.0 : 1.0);
  bool was_stopped = false;
  const Progress watched = [&](std::string_view stage, double /*fraction*/) {
    was_stopped = was_stopped || (progress && !progress(stage, 0.0));
    return !was_stopped;
  };
  auto surface =
      find_enclosing_surface(mesh, grid, inside, kLeastConfidence, settings.threads, watched);
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
  // Only of closed meshes do the normals of edges and corners tell inside from outside.
  GridFieldSettings samples_alone = settings;
  samples_alone.tolerance = 0.0;
  FieldBuilder builder(surface->mesh, of_surface, samples_alone, inside, progress);
  GridFieldData data = begin_data(mesh, grid);
  data.sign = report;
  if (auto stopped = builder.build(data)) return *std::move(stopped);
  if (builder.overlap().inside == 0) return no_volume;
  report.method = SignMethod::kWinding;
  report.hidden_triangles = surface->hidden_triangles;
  return data;
}

}  // namespace

Result<GridField> GridField::build(const TriangleMesh& mesh, const GridFieldSettings& settings,
                                   const Progress& whole_progress) {
  const auto plan = plan_brick_grid(mesh, settings);
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
  const auto finish = [&](Result<GridFieldData> data) -> Result<GridField> {
    if (!data) return data.error();
    data->sign = report;
    return GridField(*std::move(data));
  };
  if (settings.sign == SignMethod::kClosed) {
    return finish(build_closed(mesh, *plan, settings, report, progress));
  }
  report.defects = mesh.compute_defects();
  report.first_location = report.defects.first_location;
  report.was_turned = mesh.compute_volume() < 0.0;
  if (settings.sign == SignMethod::kAutomatic && report.defects.is_closed()) {
    auto data =
        build_closed(report.was_turned ? mesh.turned() : mesh, *plan, settings, report, progress);
    if (data || data.error().code != ErrorCode::kInvalidMesh) return finish(std::move(data));
  }
  return finish(build_by_winding(mesh, *plan, settings, report, progress));
}

}  // namespace voxshell
