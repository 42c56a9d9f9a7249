#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "mesh/box_hierarchy.h"
#include "simd/wide.h"
#include "voxshell/point_shell.h"
#include "voxshell/vector.h"

namespace voxshell {

/// An element of a shell: a point with the normal there, or a piece of an edge with the mean normal
/// of the faces beside it, or none. Meters, the mesh's frame.
struct ShellElement {
  Vec3f from;
  Vec3f to;  ///< the same as `from` for a point
  Vec3f normal;
};

std::vector<ShellElement> list_elements(const PointShell& shell);

/// The elements of a shell around places of the surface.
class ShellElements {
 public:
  /// In an order that keeps near ones together, such as that of a point-sphere tree.
  explicit ShellElements(std::span<const ShellElement> elements);

  struct Place {
    Vec3f point;
    Vec3f normal;  ///< unit length
  };
  struct Nearest {
    float distance;  ///< meters; infinite where no element faces the same way
    /// Of the place above the nearest elements along its normal: the least of all that are at most
    /// twice as far away as the nearest, and not below 0; meters.
    float height;
  };

  /// Of places near one another; elements that face away from a place do not count for it. `reach`
  /// is a guess of how far to look, which serves the next places and does not change the answers.
  void find_nearest(std::span<const Place> places, float& reach, std::span<Nearest> found) const;

 private:
  using F8 = simd::portable::F8;
  static constexpr std::size_t kEach = BoxHierarchy::kEach;
  /// Eight elements, by axis.
  struct Block {
    std::array<F8, 3> from;
    std::array<F8, 3> along;  ///< to the other end
    F8 per_length;            ///< one over its squared length; 0 for a point
    bool has_segments;        ///< otherwise they are all points
    std::array<F8, 3> normal;
  };
  struct Measured {
    F8 squared;  ///< distance; infinite of elements that face away
    F8 height;
  };

  static Measured measure(const Block& block, const Place& at);
  void find_blocks(const Bounds& around, float reach, std::vector<std::size_t>& found) const;

  std::vector<Block> blocks_;
  BoxHierarchy hierarchy_;
};

}  // namespace voxshell
