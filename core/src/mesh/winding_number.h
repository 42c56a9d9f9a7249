#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "simd/winding.h"
#include "voxshell/triangle_mesh.h"

namespace voxshell {

/// Generalised winding numbers of any triangles: how much of the directions around a point they
/// cover, signed. Of a closed mesh how often it encloses the point; of an open one a number in
/// between, which is continuous where there is no triangle. Groups of triangles far away count as
/// one (Barill, Dickson, Schmidt, Levin and Jacobson, Fast Winding Numbers for Soups and Clouds,
/// 2018), which is good to a hundredth.
class WindingNumberTree {
 public:
  explicit WindingNumberTree(const TriangleMesh& mesh);

  /// At each of some places, at less cost where those that follow one another are near.
  void compute(std::span<const Vec3> places, std::span<double> numbers) const;
  double compute(const Vec3& p) const;

 private:
  void build_node(const TriangleMesh& mesh, std::uint32_t begin, std::uint32_t end,
                  std::vector<std::uint32_t>& order, const std::vector<Vec3>& centers);

  std::vector<simd::WindingNode> nodes_;
  std::vector<double> triangles_;  ///< see simd/winding.h
};

}  // namespace voxshell
