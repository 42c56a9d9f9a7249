#include "simd/mesh_distance.h"

#include <bit>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <vector>

#include <gtest/gtest.h>

#include "simd/exact_formula.h"
#include "support/random.h"

namespace voxshell::mesh_distance_test {
namespace {

using test_support::Random;

/// Triangles as the kernels read them. Some lie at the same place and have other normals of edges
/// and corners, so that it shows which of the two is taken for the nearest.
struct Triangles {
  explicit Triangles(std::uint32_t count) : listed(count) {
    Random random(count);
    for (std::uint32_t i = 0; i < count; ++i) {
      const std::size_t same = i < 3 ? i : random.below(3) == 0 ? random.below(i) : i;
      if (same < i) {
        const auto from = records.begin() + static_cast<std::ptrdiff_t>(same) * kEach;
        const std::vector<float> copy(from, from + kEach);
        records.insert(records.end(), copy.begin(), copy.end());
      } else {
        const Vec3 a = random.in_cube(1.0);
        const Vec3 ab = random.in_cube(1.0);
        const Vec3 ac = random.in_cube(1.0);
        for (const Vec3& row : {a, ab, ac, normalized(cross(ab, ac))}) add(row, records);
        records.resize((i + std::size_t{1}) * kEach);
      }
      for (int k = 0; k < simd::kFeatureNormalFloats / 3; ++k) {
        add(random.direction(), feature_normals);
      }
    }
    std::iota(listed.begin(), listed.end(), 0u);
  }

  static constexpr std::ptrdiff_t kEach = simd::kTriangleFloats;

  static void add(const Vec3& row, std::vector<float>& to) {
    const auto rounded = static_cast<Vec3f>(row);
    to.insert(to.end(), {rounded.x, rounded.y, rounded.z});
  }

  std::vector<std::uint32_t> listed;
  std::vector<float> records;
  std::vector<float> feature_normals;
};

TEST(MeshDistanceKernels, GiveManyPlacesTheDistancesOfEachAlone) {
  for (const std::uint32_t count : {1u, 3u, 8u, 9u, 40u, 256u, 300u}) {
    const Triangles triangles(count);
    const simd::portable::ListedTriangles list{
        triangles.listed.data(), count, triangles.records.data(), triangles.feature_normals.data()};
    Random random(5);
    std::vector<float> places;
    for (int i = 0; i < 125; ++i) Triangles::add(random.in_cube(2.0), places);
    std::vector<float> distances(places.size() / 3);
    simd::mesh_distance_kernels().evaluate_listed(
        list.triangles, list.feature_normals, list.listed, count, places.data(),
        static_cast<std::uint32_t>(distances.size()), distances.data());
    for (std::size_t i = 0; i < distances.size(); ++i) {
      const float* p = &places[3 * i];
      const float alone = simd::portable::evaluate_triangles(list, p[0], p[1], p[2]).distance;
      EXPECT_EQ(std::bit_cast<std::uint32_t>(distances[i]), std::bit_cast<std::uint32_t>(alone))
          << count << " triangles, place " << i;
    }
  }
}

}  // namespace
}  // namespace voxshell::mesh_distance_test
