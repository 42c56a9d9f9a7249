#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "base/parallel.h"
#include "base/text.h"
#include "field/brick_bounds.h"
#include "field/brick_entry.h"
#include "field/brick_grid.h"
#include "field/enclosing_surface.h"
#include "field/flat_regions.h"
#include "field/inside.h"
#include "field/surface_bricks.h"
#include "mesh/closest_point.h"
#include "mesh/distance_tree.h"
#include "mesh/row_winding.h"
#include "voxshell/grid_field.h"

namespace voxshell {
namespace {

using simd::kBrickCells;

constexpr std::string_view kStage = "distance field";
/// A plane may be off the distances at a brick's nodes by this, voxels.
constexpr double kPlaneTolerance = 1.0 / 1024.0;
/// A field is refused where fewer places than this are clearly inside or outside.
constexpr double kLeastConfidence = 0.5;
/// Half the edge and half the diagonal of a brick, voxels.
constexpr double kHalfEdge = 0.5 * kBrickCells;
const double kHalfDiagonal = std::sqrt(3.0) * kHalfEdge;

/// A progress that is one part of another.
Progress part_of(const Progress& whole, double from, double to) {
  if (!whole) return {};
  return [&whole, from, to](std::string_view stage, double fraction) {
    return whole(stage, from + (to - from) * fraction);
  };
}

/// Places that lie in several layers of the mesh, or in one that is inside out.
struct OverlapCount {
  std::size_t places = 0;
  std::size_t of = 0;
  std::size_t inside = 0;  ///< of these
  Vec3 first{};

  void add(const OverlapCount& other) {
    if (places == 0) first = other.first;
    places += other.places;
    of += other.of;
    inside += other.inside;
  }
};

/// Signed distances at the corners of all bricks.
struct CornerLattice {
  std::array<std::size_t, 3> nodes;
  std::vector<float> distances;  ///< voxels

  std::size_t index(std::size_t x, std::size_t y, std::size_t z) const {
    return x + nodes[0] * (y + nodes[1] * z);
  }
  std::array<double, 8> corners_of(const std::array<std::size_t, 3>& brick) const {
    std::array<double, 8> corners{};
    for (std::size_t i = 0; i < 8; ++i) {
      corners[i] = static_cast<double>(
          distances[index(brick[0] + (i & 1), brick[1] + (i >> 1 & 1), brick[2] + (i >> 2))]);
    }
    return corners;
  }
};

/// How a brick is going to be held.
struct BrickPlan {
  std::int32_t cells = 0;    ///< along each axis; 0: as a plane
  std::uint32_t region = 0;  ///< of the mesh, whose plane it is
  float at_centre = 0.0f;    ///< unsigned distance, voxels
};

/// True where a field may be linear between distances at a brick's corners.
bool are_affine(const std::array<double, 8>& d) {
  constexpr double kTolerance = 1.0 / 128.0;  // voxels
  const double x = d[1] - d[0];
  const double y = d[2] - d[0];
  const double z = d[4] - d[0];
  return std::abs(d[3] - d[0] - x - y) <= kTolerance &&
         std::abs(d[5] - d[0] - x - z) <= kTolerance &&
         std::abs(d[6] - d[0] - y - z) <= kTolerance &&
         std::abs(d[7] - d[0] - x - y - z) <= kTolerance;
}

/// The fewest cells that are likely to be within tolerance, as the error at the brick's centre
/// tells. It falls to a quarter with cells half as large where the field is smooth, to a half where
/// it has a ridge.
int choose_cells(const std::array<double, 8>& corners, double at_centre) {
  double mean = 0.0;
  for (const double d : corners) mean += d / 8.0;
  const bool is_inside = corners[0] < 0.0;
  const double depth = std::abs(at_centre);
  const double error = std::abs(depth - std::abs(mean));
  double tolerance = std::max(depth / 32.0, 1.0 / 8.0);
  if (is_inside) tolerance = std::min(tolerance, 1.0);
  if (is_inside) {
    // Deep inside a slope well below one tells of a ridge or peak, where depths are largest.
    Vec3 slope{};
    for (std::size_t i = 0; i < 8; ++i) {
      for (int axis = 0; axis < 3; ++axis) {
        slope[axis] += ((i >> axis & 1) != 0 ? 0.25 : -0.25) * corners[i] / kBrickCells;
      }
    }
    const double steepness = length(slope);
    if (steepness < 0.5) return kBrickCells;
    if (steepness < 0.85) return 4;
  }
  if (error <= tolerance) return 1;
  return error <= 3.0 * tolerance ? 2 : 4;
}

std::size_t samples_of(int cells) {
  const std::size_t nodes = cube(static_cast<std::size_t>(cells) + 1);
  return (nodes + simd::kSampleAlignment - 1) / simd::kSampleAlignment * simd::kSampleAlignment;
}

/// Stores distances in quanta and returns the exponent of their scale, the least in which they fit.
int store_samples(std::span<const float> distances, std::int16_t* samples) {
  float farthest = 0.0f;
  for (const float d : distances) farthest = std::max(farthest, std::abs(d));
  int exponent = 0;
  while (std::ldexp(32767.0f / simd::kQuantaPerVoxel, exponent) < farthest) ++exponent;
  const float scale = std::ldexp(static_cast<float>(simd::kQuantaPerVoxel), -exponent);
  for (std::size_t i = 0; i < distances.size(); ++i) {
    samples[i] = static_cast<std::int16_t>(std::lrint(distances[i] * scale));
  }
  return exponent;
}

class Builder {
 public:
  Builder(const TriangleMesh& mesh, const BrickGridPlan& plan, const GridFieldSettings& settings,
          const Inside& inside, const Progress& progress)
      : mesh_(mesh),
        grid_(plan.grid),
        is_fine_(plan.is_fine),
        threads_(settings.threads),
        inside_(inside),
        progress_(progress),
        flat_(mesh, kPlaneTolerance * plan.grid.voxel_size),
        tree_(mesh, plan.grid.origin, plan.grid.voxel_size, settings.threads) {}

  /// What stopped it, if anything did.
  std::optional<Error> build(GridFieldData& data) {
    Error cancelled{ErrorCode::kCancelled, "building the distance field was stopped"};
    if (!measure_corners() || !plan_bricks()) return cancelled;
    if (!place_bricks(data)) {
      return Error{ErrorCode::kTooLarge,
                   format_text("a distance field of voxel size %.3g m has more samples than can be "
                               "numbered; use a voxel size of at least %.3g m",
                               grid_.voxel_size, 1.2 * grid_.voxel_size)};
    }
    if (!fill_bricks(data) || !compute_brick_bounds(data, threads_, part_of(progress_, 0.9, 1.0))) {
      return cancelled;
    }
    return std::nullopt;
  }

  const OverlapCount& overlap() const { return overlap_; }
  const InsideTally& tally() const { return tally_; }

 private:
  Vec3 centre_of(const std::array<std::size_t, 3>& place) const {
    const auto at = [&](std::size_t axis) {
      return static_cast<double>(kBrickCells * place[axis]) + kHalfEdge;
    };
    return {at(0), at(1), at(2)};
  }
  static void count_overlap(int layers, float distance, const Vec3& place, OverlapCount& overlap) {
    constexpr float kOnSurface = 0.02f;  // voxels
    ++overlap.of;
    overlap.inside += layers > 0 && distance > kOnSurface;
    if (layers == 0 || layers == 1 || distance <= 1.0f) return;
    if (overlap.places++ == 0) overlap.first = place;
  }
  bool measure_corners() {
    lattice_.nodes = {grid_.bricks[0] + 1, grid_.bricks[1] + 1, grid_.bricks[2] + 1};
    const auto [nx, ny, nz] = lattice_.nodes;
    lattice_.distances.resize(nx * ny * nz);
    std::vector<OverlapCount> overlaps(ny * nz);
    std::vector<InsideTally> tallies(ny * nz);
    const auto measure_row = [&](std::size_t row) {
      const std::size_t j = row % ny;
      const std::size_t k = row / ny;
      std::vector<int> layers(nx);
      inside_.find_corners(j, k, layers, tallies[row]);
      DistanceTree::Nearest nearest{};
      for (std::size_t i = 0; i < nx; ++i) {
        const Vec3 in_voxels{static_cast<double>(kBrickCells * i),
                             static_cast<double>(kBrickCells * j),
                             static_cast<double>(kBrickCells * k)};
        nearest = tree_.find_nearest(in_voxels, nearest.guess);
        const float distance = nearest.distance;
        lattice_.distances[lattice_.index(i, j, k)] = layers[i] > 0 ? -distance : distance;
        count_overlap(layers[i], distance,
                      grid_.node(kBrickCells * i, kBrickCells * j, kBrickCells * k), overlaps[row]);
      }
    };
    const bool is_done =
        parallel_for(ny * nz, threads_, kStage, part_of(progress_, 0.0, 0.1), measure_row);
    for (const OverlapCount& of_row : overlaps) overlap_.add(of_row);
    for (const InsideTally& of_row : tallies) tally_.add(of_row);
    return is_done;
  }

  bool plan_bricks() {
    plans_.resize(grid_.count());
    const std::size_t nx = grid_.bricks[0];
    const auto plan_row = [&](std::size_t row) {
      DistanceTree::Nearest nearest{};
      PlaneWork work;
      for (std::size_t brick = row * nx; brick < (row + 1) * nx; ++brick) {
        const auto place = grid_.place(brick);
        const auto corners = lattice_.corners_of(place);
        BrickPlan& plan = plans_[brick];
        nearest = tree_.find_nearest(centre_of(place), nearest.guess);
        plan.at_centre = nearest.distance;
        const auto at_centre = static_cast<double>(plan.at_centre);
        if (are_affine(corners) && is_plane(place, corners, at_centre, nearest.triangle, work)) {
          plan.region = flat_.region_of(nearest.triangle);
        } else if (is_fine_[brick] != 0) {
          plan.cells = kBrickCells;
        } else {
          plan.cells = choose_cells(corners, at_centre);
        }
      }
    };
    return parallel_for(grid_.bricks[1] * grid_.bricks[2], threads_, kStage,
                        part_of(progress_, 0.1, 0.3), plan_row);
  }

  /// What one thread looks for planes with.
  struct PlaneWork {
    std::vector<std::uint32_t> nearby;
    DistanceTree::Scratch scratch;
    std::array<float, cube(kBrickCells + 1)> nodes;
  };

  /// Whether the distances at a brick's nodes are those to the plane that triangle `nearest`, the
  /// one nearest to its centre, lies in.
  bool is_plane(const std::array<std::size_t, 3>& place, const std::array<double, 8>& corners,
                double at_centre, std::uint32_t nearest, PlaneWork& work) const {
    constexpr std::size_t kMostTriangles = 2048;
    constexpr std::size_t kMostToMeasure = 64;
    const double h = grid_.voxel_size;
    const std::uint32_t region = flat_.region_of(nearest);
    const auto& plane = flat_.plane(region);
    const Vec3 in_voxels = centre_of(place);
    const Vec3 centre = grid_.origin + h * in_voxels;
    const auto above = [&](const Vec3& offset) {
      return (dot(plane.normal, centre) - plane.offset) / h + dot(plane.normal, offset);
    };
    const auto is_off = [&](double value, double expected) {
      return !(std::abs(value - expected) <= 1.5 * kPlaneTolerance);
    };
    if (is_off(std::abs(above({})), at_centre)) return false;
    for (std::size_t i = 0; i < 8; ++i) {
      const Vec3 offset{(i & 1) != 0 ? kHalfEdge : -kHalfEdge,
                        (i & 2) != 0 ? kHalfEdge : -kHalfEdge,
                        (i & 4) != 0 ? kHalfEdge : -kHalfEdge};
      if (is_off(above(offset), corners[i])) return false;
    }
    // Triangles that may be the nearest of any place in the brick.
    const double reach_voxels = at_centre + 2.0 * kHalfDiagonal + 1e-3;
    const double reach = h * reach_voxels;
    std::vector<std::uint32_t>& nearby = work.nearby;
    if (!tree_.find_within(in_voxels, reach_voxels, kMostTriangles, nearby)) return false;
    std::erase_if(nearby, [&](std::uint32_t triangle) {
      const Vec3 closest = closest_point_on_triangle(centre, mesh_.corners(triangle));
      return squared_length(closest - centre) > reach * reach;
    });
    if (flat_.spans_cube(nearby, centre, kHalfEdge * h)) return true;
    if (nearby.size() > kMostToMeasure) return false;
    tree_.measure_brick(in_voxels, static_cast<float>(at_centre), work.scratch, work.nodes);
    std::size_t node = 0;
    for (int k = 0; k <= kBrickCells; ++k) {
      for (int j = 0; j <= kBrickCells; ++j) {
        for (int i = 0; i <= kBrickCells; ++i, ++node) {
          const Vec3 offset{i - kHalfEdge, j - kHalfEdge, k - kHalfEdge};
          if (is_off(static_cast<double>(work.nodes[node]), std::abs(above(offset)))) return false;
        }
      }
    }
    return true;
  }

  /// Gives each brick its samples or plane. False where there are too many.
  bool place_bricks(GridFieldData& data) {
    const std::size_t count = grid_.count();
    data.entries.resize(count);
    std::size_t samples = 0;
    std::vector<std::uint32_t> indices(count, kNoPlane);
    std::vector<std::uint32_t> index_of_region(mesh_.triangles().size(), kNoPlane);
    for (std::size_t brick = 0; brick < count; ++brick) {
      const BrickPlan& plan = plans_[brick];
      if (samples >= kMostPayloads * simd::kSampleAlignment) return false;
      if (plan.cells > 0) {
        data.entries[brick] = BrickEntry{.cells = plan.cells, .first = samples}.pack();
        samples += samples_of(plan.cells);
        continue;
      }
      std::uint32_t& index = index_of_region[plan.region];
      if (index == kNoPlane) {
        index = static_cast<std::uint32_t>(data.planes.size() / 4);
        const auto& plane = flat_.plane(plan.region);
        const auto normal = static_cast<Vec3f>(plane.normal);
        data.planes.insert(data.planes.end(),
                           {normal.x, normal.y, normal.z, static_cast<float>(plane.offset)});
      }
      indices[brick] = index;
    }
    data.samples.resize(std::max<std::size_t>(samples, simd::kFewestSamples));
    const std::vector<int> radii = measure_same_around(indices);
    for (std::size_t brick = 0; brick < count; ++brick) {
      if (indices[brick] == kNoPlane) continue;
      data.entries[brick] =
          BrickEntry{.is_plane = true, .radius = radii[brick], .first = indices[brick]}.pack();
    }
    return true;
  }

  /// How many bricks around each, in every direction, are of the same plane; the grid ends there.
  /// The chessboard distance to the nearest of another, in two passes (Rosenfeld and Pfaltz 1966).
  std::vector<int> measure_same_around(const std::vector<std::uint32_t>& indices) const {
    const auto [nx, ny, nz] = grid_.bricks;
    std::vector<int> radii(indices.size(), simd::kFieldMask);
    const auto visit = [&](std::size_t brick, bool is_first_pass) {
      const auto [x, y, z] = grid_.place(brick);
      if (indices[brick] == kNoPlane || x == 0 || y == 0 || z == 0 || x + 1 == nx || y + 1 == ny ||
          z + 1 == nz) {
        radii[brick] = 0;
        return;
      }
      int least = radii[brick];
      for (std::size_t c = z - 1; c <= z + 1; ++c) {
        for (std::size_t b = y - 1; b <= y + 1; ++b) {
          for (std::size_t a = x - 1; a <= x + 1; ++a) {
            const std::size_t other = a + nx * (b + ny * c);
            if (indices[other] != indices[brick]) {
              least = 0;
            } else if (is_first_pass ? other < brick : other > brick) {
              least = std::min(least, radii[other] + 1);
            }
          }
        }
      }
      radii[brick] = least;
    };
    for (std::size_t brick = 0; brick < indices.size(); ++brick) visit(brick, true);
    for (std::size_t brick = indices.size(); brick-- > 0;) visit(brick, false);
    return radii;
  }

  bool fill_bricks(GridFieldData& data) {
    const auto [nx, ny, nz] = grid_.bricks;
    struct RowResult {
      OverlapCount overlap;
      InsideTally tally;
      double rounding = 0.0;  ///< largest, of a cell's size
      double floor = 1e30;    ///< nearest that a coarse brick may come, voxels
    };
    std::vector<RowResult> results(ny * nz);
    const auto fill_row = [&](std::size_t row) {
      DistanceTree::Scratch scratch;
      RowResult& result = results[row];
      std::array<float, cube(kBrickCells + 1)> distances;
      for (std::size_t brick = row * nx; brick < (row + 1) * nx; ++brick) {
        const BrickPlan& plan = plans_[brick];
        if (plan.cells == 0) continue;
        const auto place = grid_.place(brick);
        const auto corners = lattice_.corners_of(place);
        const std::span<float> nodes(distances.data(),
                                     cube(static_cast<std::size_t>(plan.cells) + 1));
        if (plan.cells == 1) {
          std::copy(corners.begin(), corners.end(), nodes.begin());
        } else {
          measure(centre_of(place), plan, scratch, nodes);
          if (plan.cells == kBrickCells) {
            sign_fine(place, nodes, result.overlap, result.tally);
          } else if (corners[0] < 0.0) {
            for (float& d : nodes) d = -d;
          }
        }
        BrickEntry entry = BrickEntry::unpack(data.entries[brick]);
        entry.exponent = store_samples(nodes, &data.samples[entry.first]);
        data.entries[brick] = entry.pack();
        const double size = static_cast<double>(kBrickCells) / plan.cells;
        result.rounding = std::max(result.rounding,
                                   std::ldexp(0.5 / simd::kQuantaPerVoxel, entry.exponent) / size);
        if (plan.cells < kBrickCells) {
          result.floor = std::min(result.floor, find_nearest(nodes, size));
        }
      }
    };
    if (!parallel_for(ny * nz, threads_, kStage, part_of(progress_, 0.3, 0.9), fill_row)) {
      return false;
    }
    double rounding = 0.0;
    double floor = 1e30;
    for (const RowResult& result : results) {
      overlap_.add(result.overlap);
      tally_.add(result.tally);
      rounding = std::max(rounding, result.rounding);
      floor = std::min(floor, result.floor);
    }
    constexpr double kFloatError = 1e-3;  // voxels
    data.error = (std::sqrt(0.75) + rounding + kFloatError) * grid_.voxel_size;
    constexpr double kRounding = kFloatError + 0.5 / simd::kQuantaPerVoxel;
    data.coarse_floor = floor < 1e30 ? (std::max(kFineMargin, floor) - kRounding) * grid_.voxel_size
                                     : static_cast<double>(simd::kNoCoarseFloor);
    return true;
  }

  void measure(const Vec3& centre, const BrickPlan& plan, DistanceTree::Scratch& scratch,
               std::span<float> nodes) const {
    if (plan.cells == kBrickCells) {
      tree_.measure_brick(centre, plan.at_centre, scratch, nodes);
      return;
    }
    const double spacing = static_cast<double>(kBrickCells) / plan.cells;
    const Vec3 first = centre - Vec3{kHalfEdge, kHalfEdge, kHalfEdge};
    DistanceTree::Nearest nearest{};
    std::size_t node = 0;
    for (int k = 0; k <= plan.cells; ++k) {
      for (int j = 0; j <= plan.cells; ++j) {
        for (int i = 0; i <= plan.cells; ++i, ++node) {
          nearest =
              tree_.find_nearest(first + spacing * Vec3{1.0 * i, 1.0 * j, 1.0 * k}, nearest.guess);
          nodes[node] = nearest.distance;
        }
      }
    }
  }

  /// No point of a brick is nearer to the surface than this, voxels.
  static double find_nearest(std::span<const float> nodes, double size) {
    float least = std::abs(nodes[0]);
    for (const float d : nodes) least = std::min(least, std::abs(d));
    return static_cast<double>(least) - 0.5 * std::sqrt(3.0) * size;
  }

  void sign_fine(const std::array<std::size_t, 3>& place, std::span<float> nodes,
                 OverlapCount& overlap, InsideTally& tally) const {
    constexpr std::size_t kNodes = kBrickCells + 1;
    std::array<int, cube(kNodes)> layers{};
    inside_.find_nodes(place, nodes, layers, tally);
    for (std::size_t node = 0; node < layers.size(); ++node) {
      count_overlap(layers[node], nodes[node],
                    grid_.node(kBrickCells * place[0] + node % kNodes,
                               kBrickCells * place[1] + node / kNodes % kNodes,
                               kBrickCells * place[2] + node / (kNodes * kNodes)),
                    overlap);
      if (layers[node] > 0) nodes[node] = -nodes[node];
    }
  }

  static constexpr std::uint32_t kNoPlane = 0xffffffffu;

  const TriangleMesh& mesh_;
  const BrickGrid& grid_;
  const std::vector<char>& is_fine_;
  unsigned threads_;
  const Inside& inside_;
  const Progress& progress_;
  FlatRegions flat_;
  DistanceTree tree_;
  CornerLattice lattice_;
  std::vector<BrickPlan> plans_;
  OverlapCount overlap_;
  InsideTally tally_;
};

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
  Builder builder(mesh, plan, settings, inside, progress);
  GridFieldData data = begin_data(mesh, grid);
  if (auto stopped = builder.build(data)) return *std::move(stopped);
  const OverlapCount& overlap = builder.overlap();
  if (overlap.places > 0) {
    report.overlaps = overlap.places;
    report.first_location = overlap.first;
    return Error{ErrorCode::kInvalidMesh,
                 format_text("mesh overlaps itself by more than a voxel: %zu of %zu grid nodes "
                             "looked at are enclosed more than once or inside out (first near %s "
                             "metres); unite its parts, or let winding numbers tell what is inside",
                             overlap.places, overlap.of, format_point(overlap.first).c_str())};
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
  const Progress first_part = part_of(progress, 0.0, 0.0);
  const Progress watched = [&](std::string_view stage, double fraction) {
    was_stopped = was_stopped || (first_part && !first_part(stage, fraction));
    return !was_stopped;
  };
  auto surface = find_enclosing_surface(mesh, grid, inside, settings.threads, watched);
  if (!surface) return was_stopped ? cancelled : no_volume;
  const BrickGridPlan of_surface{grid, find_surface_bricks(surface->mesh, grid, kFineMargin)};
  Builder builder(surface->mesh, of_surface, settings, inside, progress);
  GridFieldData data = begin_data(mesh, grid);
  if (auto stopped = builder.build(data)) return *std::move(stopped);
  const InsideTally& tally = builder.tally();
  if (builder.overlap().inside == 0) return no_volume;
  report.method = SignMethod::kWinding;
  report.hidden_triangles = surface->hidden_triangles;
  report.confidence = 1.0 - static_cast<double>(tally.unsure) /
                                static_cast<double>(std::max<std::size_t>(tally.places, 1));
  // In a cell that the limit of the inside cuts it crosses an edge.
  report.cap_error = surface->caps > 0 ? std::sqrt(3.0) * grid.voxel_size : 0.0;
  if (report.confidence < kLeastConfidence) {
    return Error{ErrorCode::kInvalidMesh,
                 format_text("it is in doubt what the mesh has inside: %zu of %zu places looked at "
                             "have a winding number near a half (%zu open, %zu non-manifold and "
                             "%zu wrongly oriented edges, first near %s metres); repair it",
                             tally.unsure, tally.places, report.defects.open_edges,
                             report.defects.non_manifold_edges, report.defects.flipped_edges,
                             format_point(report.defects.first_location).c_str())};
  }
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
