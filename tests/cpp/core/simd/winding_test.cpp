#include "simd/winding.h"

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <vector>

#include <gtest/gtest.h>

#include "mesh/winding_number.h"
#include "simd/isa.h"
#include "support/brute_force.h"
#include "support/meshes.h"
#include "support/random.h"

namespace voxshell::winding_test {
namespace {

using namespace test_support;

/// A leaf with all the triangles of a mesh, as tables of the kernels.
struct Leaf {
  explicit Leaf(const TriangleMesh& mesh) {
    for (std::size_t i = 0; i < mesh.triangles().size(); ++i) {
      for (const Vec3& corner : mesh.corners(i)) {
        triangles.insert(triangles.end(), {corner.x, corner.y, corner.z});
      }
    }
    node.radius = 10.0;
    node.count = static_cast<std::uint32_t>(mesh.triangles().size());
  }
  simd::WindingView view() const { return {&node, triangles.data()}; }

  simd::WindingNode node{};
  std::vector<double> triangles;
};

/// Places near to the mesh and far from it, at its corners, and within one of its planes.
std::vector<Vec3> make_places(const TriangleMesh& mesh) {
  Random random(31);
  std::vector<Vec3> places;
  for (int i = 0; i < 403; ++i) places.push_back(random.in_cube(i < 200 ? 0.7 : 4.0));
  places.insert(places.end(), mesh.vertices().begin(), mesh.vertices().end());
  for (std::size_t i = 0; i < mesh.triangles().size(); ++i) {
    const auto [a, b, c] = mesh.corners(i);
    places.push_back((a + b + c) / 3.0);
    places.push_back(2.0 * a - b);
  }
  return places;
}

std::vector<std::uint64_t> to_bits(const std::vector<double>& numbers) {
  std::vector<std::uint64_t> bits;
  for (const double number : numbers) bits.push_back(std::bit_cast<std::uint64_t>(number));
  return bits;
}

TEST(WindingKernels, GivePlacesTogetherTheBitsOfEachAlone) {
  for (const Soup& soup : {make_blob(0.5, 3), opened(make_icosphere(0.5, 3), 0.2)}) {
    const TriangleMesh mesh = soup.mesh();
    const WindingNumberTree tree(mesh);
    const std::vector<Vec3> places = make_places(mesh);
    std::vector<double> together(places.size());
    tree.compute(places, together);
    std::vector<double> alone;
    for (const Vec3& p : places) alone.push_back(tree.compute(p));
    EXPECT_EQ(to_bits(together), to_bits(alone));
    EXPECT_GT(std::ranges::count_if(together, [](double n) { return n > 0.5; }), 50);
  }
}

TEST(WindingKernels, GiveTheSameBitsWithEveryInstructionSet) {
  const simd::WindingKernels& active = simd::winding_kernels();
  const TriangleMesh mesh = make_box({0.5, 0.25, 0.1}).mesh();
  const Leaf leaf(mesh);
  const std::vector<Vec3> places = make_places(mesh);
  std::vector<double> numbers(places.size());
  active.compute(leaf.view(), &places.front().x, static_cast<std::int64_t>(places.size()),
                 numbers.data());
  std::vector<double> portable(places.size());
  simd::kPortableWinding.compute(leaf.view(), &places.front().x,
                                 static_cast<std::int64_t>(places.size()), portable.data());
  EXPECT_EQ(to_bits(numbers), to_bits(portable));
  for (std::size_t i = 0; i < 403; ++i) {
    EXPECT_NEAR(numbers[i], winding_number(places[i], mesh), 1e-12);
  }
}

}  // namespace
}  // namespace voxshell::winding_test
