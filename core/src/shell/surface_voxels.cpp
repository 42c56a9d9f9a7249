#include "shell/surface_voxels.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <limits>
#include <span>
#include <string_view>

#include "mesh/closest_point.h"
#include "voxshell/parallel.h"

namespace voxshell {
namespace {

/// A convex polygon in a plane: a triangle cut by axis-aligned planes. Each of the six cuts adds at
/// most one corner; more can only come of rounding and are left out.
struct Polygon {
  static constexpr std::size_t kMaxCorners = 12;
  std::array<Vec3, kMaxCorners> corners;
  std::size_t count = 0;

  void add(const Vec3& p) {
    if (count < kMaxCorners) corners[count++] = p;
  }
  bool is_empty() const { return count < 3; }
};

/// Cuts a polygon in two by the plane at `position` on an axis.
template <int kAxis>
void split(const Polygon& polygon, double position, Polygon& below, Polygon& above) {
  below.count = 0;
  above.count = 0;
  const Vec3* a = &polygon.corners[polygon.count - 1];
  double beyond_a = (*a)[kAxis] - position;
  for (std::size_t i = 0; i < polygon.count; ++i) {
    const Vec3& b = polygon.corners[i];
    const double beyond_b = b[kAxis] - position;
    if ((beyond_a < 0.0 && beyond_b > 0.0) || (beyond_a > 0.0 && beyond_b < 0.0)) {
      Vec3 crossing = *a + (beyond_a / (beyond_a - beyond_b)) * (b - *a);
      crossing[kAxis] = position;
      below.add(crossing);
      above.add(crossing);
    }
    if (beyond_b <= 0.0) below.add(b);
    if (beyond_b >= 0.0) above.add(b);
    a = &b;
    beyond_a = beyond_b;
  }
}

double compute_area(const Polygon& polygon) {
  Vec3 doubled{};
  for (std::size_t i = 2; i < polygon.count; ++i) {
    doubled +=
        cross(polygon.corners[i - 1] - polygon.corners[0], polygon.corners[i] - polygon.corners[0]);
  }
  return length(doubled) / 2.0;
}

struct Closest {
  Vec3 point;
  double squared_distance = std::numeric_limits<double>::infinity();

  void consider(const Vec3& candidate, const Vec3& p) {
    const double squared = squared_length(p - candidate);
    if (squared >= squared_distance) return;
    point = candidate;
    squared_distance = squared;
  }
};

using Voxel = std::array<std::uint32_t, 3>;  ///< index along x, y, z

std::uint64_t hash(const Voxel& voxel) {  // by the steps of SplitMix64
  std::uint64_t h = 0;
  for (const std::uint32_t index : voxel) {
    h += index;
    h = (h ^ (h >> 30)) * 0xBF58476D1CE4E5B9u;
    h = (h ^ (h >> 27)) * 0x94D049BB133111EBu;
  }
  return h >> 32;
}

/// A part of a triangle: what one voxel holds of it.
struct Piece {
  Vec3 point;  ///< closest to the voxel's center; grid axes
  double area;
  Vec3f to_middle;  ///< from there to the mean of the corners
  std::uint32_t triangle;
  Voxel voxel;
};

/// For a needle, whose plane is mere rounding.
void measure_needle(const Polygon& polygon, const Vec3& center, Closest& closest, double& area) {
  area = compute_area(polygon);
  for (std::size_t i = 2; i < polygon.count; ++i) {
    closest.consider(closest_point_on_triangle(
                         center, {polygon.corners[0], polygon.corners[i - 1], polygon.corners[i]}),
                     center);
  }
}

/// The plane's point closest to the center sees an edge from outside, or lies in the polygon. The
/// triangles that it makes with the edges are the area.
void measure_polygon(const Polygon& polygon, const Vec3& normal, const Vec3& center,
                     Closest& closest, double& area) {
  const Vec3 on_plane = center - dot(center - polygon.corners[0], normal) * normal;
  double doubled = 0.0;
  bool is_inside = true;
  Vec3 a = polygon.corners[polygon.count - 1];
  Vec3 to_a = a - on_plane;
  for (std::size_t i = 0; i < polygon.count; ++i) {
    const Vec3& b = polygon.corners[i];
    const Vec3 to_b = b - on_plane;
    const double part = dot(normal, cross(to_a, to_b));
    doubled += part;
    if (part < 0.0) {
      is_inside = false;
      const Vec3 edge = to_b - to_a;
      const double along = -dot(to_a, edge);
      const double squared = squared_length(edge);
      closest.consider(along <= 0.0       ? a
                       : along >= squared ? b
                                          : a + (along / squared) * edge,
                       center);
    }
    a = b;
    to_a = to_b;
  }
  if (is_inside) closest.consider(on_plane, center);
  area = 0.5 * doubled;
}

/// Some triangles, or a slice of a large one: a task that ends soon.
struct Unit {
  std::uint32_t first;
  std::uint32_t count;
  double expected_pieces = 0.0;
  int axis = 0;  ///< of the slice
  std::int64_t low = 0;
  std::int64_t high = std::numeric_limits<std::int64_t>::max();  ///< slabs of the slice: to below

  bool is_slice() const { return high != std::numeric_limits<std::int64_t>::max(); }
};

/// Pieces in buckets by where they are, so that a bucket is a task: all pieces of a voxel are in
/// one.
struct UnitPieces {
  std::vector<Piece> pieces;                ///< bucket by bucket
  std::vector<std::uint32_t> bucket_begin;  ///< one more than there are buckets

  std::span<const Piece> bucket(std::size_t i) const {
    return std::span(pieces).subspan(bucket_begin[i], bucket_begin[i + 1] - bucket_begin[i]);
  }
};

/// A mesh in the axes of a grid.
struct GriddedMesh {
  std::vector<Vec3> vertices;
  std::span<const Triangle> triangles;
  std::vector<Vec3> normals;  ///< of triangles; zero for needles
  Bounds bounds;
  double spacing;
  Vec3 origin{};  ///< where the voxels with index 0 begin

  GriddedMesh(const TriangleMesh& mesh, const VoxelGrid& grid)
      : triangles(mesh.triangles()), spacing(grid.spacing) {
    vertices.reserve(mesh.vertices().size());
    for (const Vec3& vertex : mesh.vertices()) {
      vertices.push_back(grid.grid_from_mesh * vertex);
      bounds.extend(vertices.back());
    }
    normals.reserve(triangles.size());
    for (const auto& [a, b, c] : triangles) {
      normals.push_back(compute_triangle_normal(vertices[a], vertices[b], vertices[c]));
    }
    for (int axis = 0; axis < 3; ++axis) {
      // A whole number of voxels with the mesh in their middle, so that no flat side of it lies on
      // a face between voxels; a side of whole voxels must not end up on either side by rounding.
      constexpr double kRounding = 1e-6;
      constexpr double kSpare = 2.0;  // so that no index is negative, whatever the shift
      const double voxels = std::floor(bounds.extents()[axis] / spacing + kRounding) + 1.0;
      origin[axis] = bounds.center()[axis] + (grid.shift[axis] - 0.5 * voxels - kSpare) * spacing;
    }
  }

  std::int64_t slab(double coordinate, int axis) const {
    // Not floor(): without the instruction for it, that is a call.
    return static_cast<std::int64_t>(std::max(0.0, (coordinate - origin[axis]) / spacing));
  }
  double face(std::int64_t slab, int axis) const {
    return origin[axis] + static_cast<double>(slab) * spacing;
  }
  Vec3 center(const Voxel& voxel) const {
    return origin + spacing * Vec3{voxel[0] + 0.5, voxel[1] + 0.5, voxel[2] + 0.5};
  }

  /// How many voxels a triangle passes, on average over all places of the grid: of the Minkowski
  /// sum of a convex set and a cube the volume, in voxels.
  double expected_pieces(std::size_t triangle) const {
    const auto& [a, b, c] = triangles[triangle];
    Bounds box;
    for (const std::uint32_t corner : {a, b, c}) box.extend(vertices[corner]);
    const Vec3 e = box.extents() / spacing;
    const Vec3 w =
        cross(vertices[b] - vertices[a], vertices[c] - vertices[a]) / (2.0 * spacing * spacing);
    return 1.0 + e.x + e.y + e.z + std::abs(w.x) + std::abs(w.y) + std::abs(w.z);
  }
};

std::vector<Unit> divide_into_units(const GriddedMesh& mesh) {
  constexpr double kPiecesAUnit = 4096.0;
  std::vector<Unit> units;
  for (std::uint32_t i = 0; i < mesh.triangles.size(); ++i) {
    const double expected = mesh.expected_pieces(i);
    if (expected <= kPiecesAUnit) {
      if (units.empty() || units.back().expected_pieces + expected > kPiecesAUnit) {
        units.push_back({i, 0});
      }
      units.back().expected_pieces += expected;
      ++units.back().count;
      continue;
    }
    Bounds bounds;
    for (const std::uint32_t corner : mesh.triangles[i]) bounds.extend(mesh.vertices[corner]);
    const int axis = bounds.longest_axis();
    const std::int64_t low = mesh.slab(bounds.lower[axis], axis);
    const std::int64_t high = mesh.slab(bounds.upper[axis], axis) + 1;
    const auto slices = static_cast<std::int64_t>(std::ceil(expected / kPiecesAUnit));
    const std::int64_t width = (high - low + slices - 1) / slices;
    for (std::int64_t slab = low; slab < high; slab += width) {
      units.push_back({i, 1, kPiecesAUnit, axis, slab, std::min(high, slab + width)});
    }
  }
  return units;
}

/// Cuts triangles into the pieces that voxels hold.
class Cutter {
 public:
  explicit Cutter(const GriddedMesh& mesh) : mesh_(mesh) {}

  std::vector<Piece> cut(const Unit& unit) {
    constexpr double kSpare = 1.1;
    pieces_.reserve(static_cast<std::size_t>(kSpare * unit.expected_pieces));
    for (triangle_ = unit.first; triangle_ < unit.first + unit.count; ++triangle_) {
      Polygon triangle;
      for (const std::uint32_t corner : mesh_.triangles[triangle_]) {
        triangle.add(mesh_.vertices[corner]);
      }
      if (unit.is_slice()) {
        if (unit.axis == 0) slice<0>(triangle, unit);
        if (unit.axis == 1) slice<1>(triangle, unit);
        if (unit.axis == 2) slice<2>(triangle, unit);
      }
      if (!triangle.is_empty()) cut_along<0>(triangle);
    }
    return std::move(pieces_);
  }

 private:
  struct Scratch {
    Polygon below;
    Polygon rest;
    Polygon next_rest;
  };

  template <int kAxis>
  void slice(Polygon& triangle, const Unit& unit) {
    Polygon& rest = scratch_[0].rest;
    Polygon& dropped = scratch_[0].below;
    split<kAxis>(triangle, mesh_.face(unit.low, kAxis), dropped, rest);
    if (!rest.is_empty()) split<kAxis>(rest, mesh_.face(unit.high, kAxis), triangle, dropped);
    if (rest.is_empty()) triangle.count = 0;
  }

  template <int kAxis>
  void cut_along(const Polygon& polygon) {
    double low = polygon.corners[0][kAxis];
    double high = low;
    for (std::size_t i = 1; i < polygon.count; ++i) {
      low = std::min(low, polygon.corners[i][kAxis]);
      high = std::max(high, polygon.corners[i][kAxis]);
    }
    // In the plane of a face, corners lie on either side of it by rounding: cutting there would
    // count parts twice.
    constexpr double kFlat = 1e-9;  // spacings
    if (high - low <= kFlat * mesh_.spacing) low = high = 0.5 * (low + high);
    std::int64_t slab = mesh_.slab(low, kAxis);
    const std::int64_t last = mesh_.slab(high, kAxis);
    auto& [below, rest, next_rest] = scratch_[kAxis];
    const Polygon* uncut = &polygon;
    for (; slab < last && !uncut->is_empty(); ++slab) {
      split<kAxis>(*uncut, mesh_.face(slab + 1, kAxis), below, next_rest);
      std::swap(rest, next_rest);
      uncut = &rest;
      if (!below.is_empty()) finish_slab<kAxis>(below, slab);
    }
    if (!uncut->is_empty()) finish_slab<kAxis>(*uncut, slab);
  }

  template <int kAxis>
  void finish_slab(const Polygon& polygon, std::int64_t slab) {
    voxel_[kAxis] = static_cast<std::uint32_t>(slab);
    if constexpr (kAxis < 2) {
      cut_along<kAxis + 1>(polygon);
    } else {
      keep(polygon);
    }
  }

  void keep(const Polygon& polygon) {
    const Vec3 center = mesh_.center(voxel_);
    const Vec3& normal = mesh_.normals[triangle_];
    Closest closest;
    double area = 0.0;
    if (normal == Vec3{}) {
      measure_needle(polygon, center, closest, area);
    } else {
      measure_polygon(polygon, normal, center, closest, area);
    }
    if (!(area > 0.0)) return;
    Vec3 sum{};
    for (std::size_t i = 0; i < polygon.count; ++i) sum += polygon.corners[i];
    const Vec3 middle = sum / static_cast<double>(polygon.count);
    pieces_.push_back(
        {closest.point, area, static_cast<Vec3f>(middle - closest.point), triangle_, voxel_});
  }

  const GriddedMesh& mesh_;
  std::vector<Piece> pieces_;
  std::uint32_t triangle_ = 0;
  Voxel voxel_{};
  std::array<Scratch, 3> scratch_;
};

/// In the order that they have within each bucket.
UnitPieces divide_into_buckets(const std::vector<Piece>& pieces, std::size_t buckets) {
  // Neighbors stay together, for the sake of caches.
  constexpr int kBlockBits = 3;
  const auto bucket_of = [&](const Piece& piece) {
    Voxel block = piece.voxel;
    for (std::uint32_t& index : block) index >>= kBlockBits;
    return static_cast<std::uint32_t>(hash(block) % buckets);
  };
  std::vector<std::uint32_t> bucket;
  bucket.reserve(pieces.size());
  UnitPieces sorted;
  sorted.bucket_begin.assign(buckets + 1, 0);
  for (const Piece& piece : pieces) {
    bucket.push_back(bucket_of(piece));
    ++sorted.bucket_begin[bucket.back() + 1];
  }
  for (std::size_t i = 0; i < buckets; ++i) sorted.bucket_begin[i + 1] += sorted.bucket_begin[i];
  std::vector<std::uint32_t> next(sorted.bucket_begin);
  sorted.pieces.resize(pieces.size());
  for (std::size_t i = 0; i < pieces.size(); ++i) sorted.pieces[next[bucket[i]]++] = pieces[i];
  return sorted;
}

/// Sorts the pieces of one voxel into sides.
class SideSorter {
 public:
  SideSorter(const GriddedMesh& mesh, const Matrix3& mesh_from_grid)
      : mesh_(mesh), mesh_from_grid_(mesh_from_grid) {}

  void sort(std::span<const Piece* const> pieces, std::vector<SurfaceSample>& samples) {
    pieces_ = pieces;
    sides_.clear();
    for (const Piece* closest = find_closest(); closest != nullptr; closest = find_closest()) {
      sides_.push_back({normal(*closest), closest});
    }
    for (const Piece* piece : pieces_) side_of(*piece).area += piece->area;
    for (const Side& side : sides_) {
      samples.push_back(
          {mesh_from_grid_ * side.closest->point,
           static_cast<Vec3f>(mesh_from_grid_ * static_cast<Vec3>(side.closest->to_middle)),
           side.closest->triangle, side.area});
    }
  }

 private:
  struct Side {
    Vec3 normal;
    const Piece* closest;
    double area = 0.0;
  };

  const Vec3& normal(const Piece& piece) const { return mesh_.normals[piece.triangle]; }

  bool faces_away(const Piece& piece, const Side& side) const {
    return dot(normal(piece), side.normal) < kFacesAway;
  }

  /// Of those that face away from all sides, if there are any.
  const Piece* find_closest() const {
    const Piece* closest = nullptr;
    double least = 0.0;
    for (const Piece* piece : pieces_) {
      if (!std::all_of(sides_.begin(), sides_.end(),
                       [&](const Side& side) { return faces_away(*piece, side); })) {
        continue;
      }
      const double distance = normal(*piece) == Vec3{}
                                  ? std::numeric_limits<double>::infinity()
                                  : squared_length(piece->point - mesh_.center(piece->voxel));
      if (closest == nullptr || distance < least) {
        closest = piece;
        least = distance;
      }
    }
    return closest;
  }

  /// The one that the piece faces most like.
  Side& side_of(const Piece& piece) {
    return *std::max_element(sides_.begin(), sides_.end(), [&](const Side& a, const Side& b) {
      return dot(a.normal, normal(piece)) < dot(b.normal, normal(piece));
    });
  }

  const GriddedMesh& mesh_;
  const Matrix3& mesh_from_grid_;
  std::span<const Piece* const> pieces_;
  std::vector<Side> sides_;
};

/// Samples the voxels of one bucket, in the order in which they first appear.
std::vector<SurfaceSample> sample_bucket(const std::vector<UnitPieces>& units, std::size_t bucket,
                                         SideSorter sorter) {
  constexpr auto kNone = static_cast<std::uint32_t>(-1);
  struct Link {
    const Piece* piece;
    std::uint32_t next = kNone;  ///< of the same voxel
  };
  struct Chain {
    std::uint32_t first;
    std::uint32_t last;
  };
  std::size_t count = 0;
  for (const UnitPieces& unit : units) count += unit.bucket(bucket).size();
  std::vector<Link> links;
  links.reserve(count);
  std::vector<Chain> chains;
  chains.reserve(count);
  std::vector<std::uint32_t> slots(std::bit_ceil(2 * count + 1), kNone);
  for (const UnitPieces& unit : units) {
    for (const Piece& piece : unit.bucket(bucket)) {
      const auto link = static_cast<std::uint32_t>(links.size());
      links.push_back({&piece});
      std::size_t i = hash(piece.voxel) & (slots.size() - 1);
      while (slots[i] != kNone && links[chains[slots[i]].first].piece->voxel != piece.voxel) {
        i = (i + 1) & (slots.size() - 1);
      }
      if (slots[i] == kNone) {
        slots[i] = static_cast<std::uint32_t>(chains.size());
        chains.push_back({link, link});
      } else {
        Chain& chain = chains[slots[i]];
        links[chain.last].next = link;
        chain.last = link;
      }
    }
  }

  std::vector<SurfaceSample> samples;
  samples.reserve(chains.size());
  std::vector<const Piece*> pieces;
  for (const Chain& chain : chains) {
    pieces.clear();
    for (std::uint32_t i = chain.first; i != kNone; i = links[i].next) {
      pieces.push_back(links[i].piece);
    }
    sorter.sort(pieces, samples);
  }
  return samples;
}

/// `progress` for work whose 0 to 1 count `from` to `to` of the whole.
Progress part_of(const Progress& progress, double from, double to) {
  if (!progress) return {};
  return [&progress, from, to](std::string_view stage, double done) {
    return progress(stage, from + (to - from) * done);
  };
}

}  // namespace

Vec3 compute_triangle_normal(const Vec3& a, const Vec3& b, const Vec3& c) {
  constexpr double kNarrow = 1e-9;
  const Vec3 ab = b - a;
  const Vec3 ac = c - a;
  const Vec3 doubled_area = cross(ab, ac);
  const double longest = std::max({squared_length(ab), squared_length(ac), squared_length(c - b)});
  const double size = length(doubled_area);
  return size > kNarrow * longest ? doubled_area / size : Vec3{};
}

double compute_passed_area(const TriangleMesh& mesh, const Matrix3& grid_from_mesh) {
  double area = 0.0;
  for (std::size_t i = 0; i < mesh.triangles().size(); ++i) {
    const auto [a, b, c] = mesh.corners(i);
    const Vec3 doubled = grid_from_mesh * cross(b - a, c - a);
    area += 0.5 * (std::abs(doubled.x) + std::abs(doubled.y) + std::abs(doubled.z));
  }
  return area;
}

std::vector<SurfaceSample> sample_surface_voxels(const TriangleMesh& mesh, const VoxelGrid& grid,
                                                 unsigned threads, const Progress& progress) {
  constexpr std::string_view kStage = "surface voxels";
  const GriddedMesh gridded(mesh, grid);
  const std::vector<Unit> units = divide_into_units(gridded);
  constexpr std::size_t kMostBuckets = 1024;
  const std::size_t buckets = std::clamp<std::size_t>(units.size(), 1, kMostBuckets);
  std::vector<UnitPieces> pieces(units.size());
  const auto cut_unit = [&](std::size_t i) {
    pieces[i] = divide_into_buckets(Cutter(gridded).cut(units[i]), buckets);
  };
  if (!parallel_for(units.size(), threads, kStage, part_of(progress, 0.0, 0.7), cut_unit)) {
    return {};
  }

  const Matrix3 mesh_from_grid = grid.grid_from_mesh.transposed();
  std::vector<std::vector<SurfaceSample>> samples(buckets);
  const auto sample = [&](std::size_t i) {
    samples[i] = sample_bucket(pieces, i, {gridded, mesh_from_grid});
  };
  if (!parallel_for(buckets, threads, kStage, part_of(progress, 0.7, 1.0), sample)) return {};

  std::size_t count = 0;
  for (const auto& bucket : samples) count += bucket.size();
  std::vector<SurfaceSample> all;
  all.reserve(count);
  for (const auto& bucket : samples) all.insert(all.end(), bucket.begin(), bucket.end());
  return all;
}

}  // namespace voxshell
