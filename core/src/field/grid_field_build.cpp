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

Result<RowWinding> build_rows(const TriangleMesh& mesh, const BrickGrid& grid) {
  return RowWinding::build(mesh, {.origin = grid.origin,
                                  .step = grid.voxel_size,
                                  .rows_y = kBrickCells * grid.bricks[1] + 1,
                                  .rows_z = kBrickCells * grid.bricks[2] + 1});
}

Result<GridFieldData> build_closed(const TriangleMesh& mesh, const BrickGridPlan& plan,
                                   const GridFieldSettings& settings, SignReport& report,
                                   const Progress& progress) {
  if (auto closed = check_encloses_volume(mesh); !closed) {
    Error error = closed.error();
    if (!mesh.compute_defects().is_closed()) {
      error.message += ", or find its inside automatically (sign 'auto')";
    }
    return error;
  }
  const BrickGrid& grid = plan.grid;
  const auto winding = build_rows(mesh, grid);
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

/// The cutter of a closed mesh some of whose surface does not bound the body, else null: of parts
/// that overlap, of which `suspects` are the triangles near other parts, and of a part that crosses
/// itself, by however little. Samples see less of the latter than exact cells, whose signs it
/// turns.
std::shared_ptr<const SurfaceCutter> find_hidden(const TriangleMesh& mesh,
                                                 std::vector<std::uint32_t> suspects,
                                                 const GridFieldSettings& settings) {
  if (suspects.empty() && settings.tolerance == 0.0) return nullptr;
  SelfCrossings crossings(mesh);
  if (settings.tolerance > 0.0) {
    const std::vector<std::uint32_t> crossed = crossings.find_crossed(settings.threads);
    suspects.insert(suspects.end(), crossed.begin(), crossed.end());
  }
  if (suspects.empty()) return nullptr;
  constexpr bool kIsBalanced = true;  // as what is closed is
  auto cutter = std::make_shared<const SurfaceCutter>(mesh, kIsBalanced, std::move(crossings));
  return cutter->hides_any(suspects, settings.threads) ? cutter : nullptr;
}

/// Of a mesh that so many steps do not cut where it crosses itself.
Error refuse_cutting(const TriangleMesh& mesh, std::size_t steps, unsigned threads) {
  const std::vector<std::uint32_t> crossed = SelfCrossings(mesh).find_crossed(threads);
  const auto [a, b, c] = mesh.corners(crossed.empty() ? 0 : crossed.front());
  return Error{
      ErrorCode::kInvalidMesh,
      format_text("mesh crosses itself too often: %zu of its %zu triangles are crossed (first near "
                  "%s meters), and to cut them takes more than the limit of %.2g steps; unite its "
                  "parts, merge vertices that nearly coincide, or make its sheets thinner",
                  crossed.size(), mesh.triangles().size(), format_point((a + b + c) / 3.0).c_str(),
                  static_cast<double>(steps))};
}

Error refuse_crossings(const TriangleMesh& mesh, unsigned threads) {
  const std::vector<std::uint32_t> crossed = SelfCrossings(mesh).find_crossed(threads);
  const auto [a, b, c] = mesh.corners(crossed.empty() ? 0 : crossed.front());
  return Error{ErrorCode::kInvalidMesh,
               format_text("mesh crosses itself: some of its surface does not bound the body (%zu "
                           "triangles are crossed, first near %s meters); unite its parts, or use "
                           "winding numbers to find the inside",
                           crossed.size(), format_point((a + b + c) / 3.0).c_str())};
}

/// `visible` becomes what of the mesh bounds the body, where that is not all of it.
Result<GridFieldData> build_by_winding(const TriangleMesh& mesh,
                                       const std::shared_ptr<const SurfaceCutter>& cutter,
                                       const BrickGridPlan& plan, const GridFieldSettings& settings,
                                       SignReport& report, std::optional<VisibleSurface>& visible,
                                       const Progress& progress) {
  const Error no_volume{
      ErrorCode::kInvalidMesh,
      format_text("mesh encloses no volume: its winding number is above a half nowhere on the grid "
                  "(%zu open, %zu non-manifold and %zu wrongly oriented edges, first near %s "
                  "meters); repair it, or give it a thickness",
                  report.defects.open_edges, report.defects.non_manifold_edges,
                  report.defects.flipped_edges,
                  format_point(report.defects.first_location).c_str())};
  const Error canceled{ErrorCode::kCanceled, "building the distance field was stopped"};
  const BrickGrid& grid = plan.grid;
  InsideByWindingNumbers inside(grid, mesh.bounds(), *cutter);
  bool was_stopped = false;
  const Progress watched = [&](std::string_view stage, double /*fraction*/) {
    was_stopped = was_stopped || (progress && !progress(stage, 0.0));
    return !was_stopped;
  };
  auto surface = find_enclosing_surface(mesh, cutter, grid, inside, kLeastConfidence,
                                        settings.threads, watched);
  if (!surface) return was_stopped ? canceled : no_volume;
  report.confidence = surface->confidence;
  if (report.confidence < kLeastConfidence) {
    return Error{
        ErrorCode::kInvalidMesh,
        format_text("the mesh's inside is ambiguous: on %.0f %% of its area, the winding "
                    "number on one side is near a half (%zu open, %zu non-manifold and %zu "
                    "wrongly oriented edges, first near %s meters); repair it, or give it a "
                    "thickness",
                    100.0 * (1.0 - report.confidence), report.defects.open_edges,
                    report.defects.non_manifold_edges, report.defects.flipped_edges,
                    format_point(report.defects.first_location).c_str())};
  }
  if (surface->spent_steps > 0) {
    return refuse_cutting(mesh, surface->spent_steps, settings.threads);
  }
  // In a cell that the limit of the inside cuts it crosses an edge.
  report.cap_error = surface->caps > 0 ? std::sqrt(3.0) * grid.voxel_size : 0.0;
  inside.remember(std::move(surface->sides));
  const BrickGridPlan of_surface{grid, find_least_cells(surface->mesh, grid)};
  // Only of closed surfaces do the normals of edges and corners tell inside from outside.
  GridFieldSettings of_field = settings;
  if (!cutter->is_balanced() || surface->caps > 0) of_field.tolerance = 0.0;
  Features features;
  if (of_field.tolerance > 0.0) {
    features =
        surface->visible ? compute_features(mesh, *surface->visible) : compute_features(mesh);
  }
  // Without openings, crossings of rows tell the same, much sooner.
  std::optional<RowWinding> rows;
  std::optional<InsideByRows> by_rows;
  if (cutter->is_balanced()) {
    if (auto built = build_rows(mesh, grid)) {
      rows = *std::move(built);
      by_rows.emplace(grid, *rows, cutter->rounding());
    }
  }
  const Inside& tells = by_rows ? static_cast<const Inside&>(*by_rows) : inside;
  FieldBuilder builder(surface->mesh, of_surface, of_field, tells, progress, std::move(features));
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
    auto closed = build_closed(repaired.mesh, *plan, settings, report, progress);
    // Only exact cells take their signs from such surface.
    if (closed && settings.tolerance > 0.0 &&
        find_hidden(repaired.mesh, find_near_parts(repaired.mesh), settings)) {
      return refuse_crossings(repaired.mesh, settings.threads);
    }
    return finish(std::move(closed));
  }
  report.defects = repaired.found;
  report.first_location = report.defects.first_location;
  report.was_turned = repaired.mesh.compute_volume() < 0.0;
  const std::optional<TriangleMesh> turned =
      report.was_turned ? std::optional(repaired.mesh.turned()) : std::nullopt;
  const TriangleMesh& mesh = turned ? *turned : repaired.mesh;
  if (settings.sign == SignMethod::kAutomatic && repaired.is_closed) {
    const std::vector<std::uint32_t> near_parts = find_near_parts(mesh);
    // Of parts, nodes mostly tell sooner, and count how much overlaps.
    if (near_parts.empty()) cutter = find_hidden(mesh, near_parts, settings);
    if (!cutter) {
      auto closed = build_closed(mesh, *plan, settings, report, progress);
      if (closed && !near_parts.empty()) cutter = find_hidden(mesh, near_parts, settings);
      if (closed && cutter) closed = Error{ErrorCode::kInvalidMesh, "mesh overlaps itself"};
      if (closed || closed.error().code != ErrorCode::kInvalidMesh)
        return finish(std::move(closed));
    }
  }
  if (!cutter) cutter = std::make_shared<const SurfaceCutter>(mesh, repaired.is_balanced);
  return finish(build_by_winding(mesh, cutter, *plan, settings, report, visible, progress));
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
