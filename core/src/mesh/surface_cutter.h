#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "mesh/ray_winding.h"
#include "mesh/self_crossings.h"
#include "mesh/winding_number.h"
#include "voxshell/triangle_mesh.h"

namespace voxshell {

/// Winding numbers this near to a half leave in doubt what is inside.
inline constexpr double kUnsure = 0.25;

/// Winding numbers on the two sides of a place of the surface.
struct SurfaceSides {
  double front = 0.0;
  double back = 0.0;

  /// The body is on both sides, or surely on neither: the place does not bound it.
  bool is_hidden() const;
  bool is_surely_hidden_or_not() const;
};

/// How much work it may be to cut a mesh where it crosses itself, in steps: triangles that a piece
/// is compared with. Of triangles that all cross one another, the pieces grow with the third power
/// of their number. Threads may share a budget.
class CutBudget {
 public:
  explicit CutBudget(std::size_t triangles) : steps_(kSteps + kStepsATriangle * triangles) {}

  std::size_t steps() const { return steps_; }
  bool is_spent() const { return taken_.load(std::memory_order_relaxed) > steps_; }
  void take(std::size_t steps) { taken_.fetch_add(steps, std::memory_order_relaxed); }

 private:
  /// 6 to 15 seconds on two cores for triangles that all cross one another; parts of large meshes
  /// that reach into one another ask for much less. Fewer steps would refuse twenty bars that cross
  /// along one axis, more would take too long.
  static constexpr std::size_t kSteps = std::size_t{5} << 22;
  static constexpr std::size_t kStepsATriangle = std::size_t{1} << 11;

  std::size_t steps_;
  std::atomic<std::size_t> taken_ = 0;
};

/// A triangle of what is visible of a mesh.
struct VisibleTriangle {
  std::uint32_t triangle;  ///< of the mesh, that it is a piece of
  bool is_whole;           ///< it is all of that one
};

/// Tells which parts of a mesh's surface lie inside other parts of it, and cuts these off. A
/// triangle is cut along the triangles that cross or touch it, so that no piece is hidden in part.
/// Keeps no reference to the mesh. Meters.
class SurfaceCutter {
 public:
  /// `is_balanced`: at each edge of the mesh as many triangles run one way as the other, so that
  /// its winding numbers are whole.
  SurfaceCutter(const TriangleMesh& mesh, bool is_balanced)
      : SurfaceCutter(mesh, is_balanced, SelfCrossings(mesh)) {}
  /// `crossings` are those of the mesh.
  SurfaceCutter(const TriangleMesh& mesh, bool is_balanced, SelfCrossings crossings);

  /// Parts nearer together count as touching, meters.
  double rounding() const { return crossings_.rounding(); }
  bool is_balanced() const { return is_balanced_; }

  /// Generalised winding numbers.
  void compute_numbers(std::span<const Vec3> places, std::span<double> numbers) const {
    winding_.compute(places, numbers);
  }

  /// Just off a place of the surface that faces along `normal`, unit length.
  SurfaceSides look_at(const Vec3& place, const Vec3& normal) const;
  /// At the middle of a triangle.
  SurfaceSides look_at(std::uint32_t triangle) const;

  /// Whether other triangles cross a triangle, or touch it along a line.
  bool is_crossed(std::uint32_t triangle) const { return crossings_.is_crossed(triangle); }

  /// Whether any of these triangles is hidden, wholly or in part, or that is too much work to
  /// tell.
  bool hides_any(std::span<const std::uint32_t> triangles, unsigned threads) const;

  /// The visible pieces of a triangle, or none where it is visible or hidden as a whole, which
  /// `is_hidden` then says. Where an opening of the mesh leaves it in doubt what is inside, pieces
  /// become no smaller than `finest`, and their middles decide. Once the budget is spent, the
  /// result has no meaning.
  std::vector<std::array<Vec3, 3>> cut(std::uint32_t triangle, double finest, CutBudget& budget,
                                       bool& is_hidden) const;

  /// The visible parts of a straight line along the surface, whose places face along `normal`:
  /// where they begin and end, as fractions of its length.
  std::vector<std::array<double, 2>> cut_line(const Vec3& from, const Vec3& to,
                                              const Vec3& normal) const;

 private:
  class Division;

  /// Adds to `steps`.
  SurfaceSides look_from(const Vec3& front, const Vec3& back, std::size_t& steps) const;

  bool is_balanced_;
  double aside_;  ///< how far off the surface its sides are looked at
  WindingNumberTree winding_;
  std::optional<RayWinding> by_rays_;  ///< of a balanced mesh: the same numbers, sooner
  SelfCrossings crossings_;
};

/// The surface that bounds the body of a mesh that overlaps itself: triangles that are visible as a
/// whole, and the visible pieces of others.
struct VisibleSurface {
  TriangleMesh mesh;
  std::vector<VisibleTriangle> triangles;  ///< one a triangle of `mesh`, in ascending order
  std::shared_ptr<const SurfaceCutter> cutter;
};

/// The triangles that come near the bounds of another part of the mesh, ascending: of a closed mesh
/// no others can be inside another part. A part is what hangs together.
std::vector<std::uint32_t> find_near_parts(const TriangleMesh& mesh);

}  // namespace voxshell
