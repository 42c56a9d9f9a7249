#include "simd/query_kernels.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <limits>
#include <span>
#include <string>
#include <type_traits>
#include <vector>

#include <gtest/gtest.h>

#include "query/posed.h"
#include "query/walk.h"
#include "simd/isa.h"
#include "support/pairs.h"
#include "support/random.h"
#include "voxshell/contacts.h"

namespace voxshell::query_kernels_test {
namespace {

using namespace test_support;

TEST(Isa, IsTheOneThatIsForced) {
  const char* forced = std::getenv("VOXSHELL_FORCE_ISA");
  if (forced == nullptr) GTEST_SKIP() << "none is";
  ASSERT_EQ(std::string(forced), "portable");
  EXPECT_EQ(simd::active_isa(), simd::Isa::kPortable);
}

/// FNV-1a of all that kernels write.
class Hash {
 public:
  void add(const void* data, std::size_t bytes) {
    const auto* at = static_cast<const unsigned char*>(data);
    for (std::size_t i = 0; i < bytes; ++i) value_ = (value_ ^ at[i]) * 0x100000001B3u;
  }
  template <class T>
  void add(const T& value) {
    add(&value, sizeof(T));
  }
  template <class T>
  void add_all(const T* values, std::size_t count) {
    add(count);
    add(values, count * sizeof(T));
  }
  std::uint64_t value() const { return value_; }

 private:
  std::uint64_t value_ = 0xCBF29CE484222325u;
};

/// What kernels write to, large enough for a shell.
struct Room {
  explicit Room(const PointShell& shell)
      : words(8 * (shell.size() + 16)),
        numbers(13 * (shell.size() + 16)),
        size(shell.size() + 16) {}

  simd::NodeList nodes(std::size_t i) {
    return {&words[(2 * i) * size], &words[(2 * i + 1) * size], &numbers[i * size], 0};
  }
  simd::PointList points(std::size_t i = 0) {
    return {&words[(4 + 2 * i) * size],
            &words[(5 + 2 * i) * size],
            &numbers[(2 + 4 * i) * size],
            &numbers[(3 + 4 * i) * size],
            &numbers[(4 + 4 * i) * size],
            &numbers[(5 + 4 * i) * size],
            0};
  }
  float* gradient(std::size_t axis) { return &numbers[(10 + axis) * size]; }

  std::vector<std::uint32_t> words;
  std::vector<float> numbers;
  std::size_t size;
};

/// Every kernel once, one after another as queries do.
template <class V>
std::uint64_t hash_kernels(simd::Isa isa, const simd::PosedView<V>& posed, const PointShell& shell,
                           float margin, std::size_t& point_count) {
  const simd::QueryKernels<V>& kernels = simd::query_kernels<V>(isa);
  const simd::TreeView tree = view_tree(shell);
  Room room(shell);
  Hash hash;

  simd::NodeList nodes = room.nodes(0);
  simd::NodeList next = room.nodes(1);
  nodes.index[0] = nodes.tag[0] = 0;
  nodes.count = 1;
  // The same pose, with less of a margin.
  const float nearer = margin - 0.01f;
  const simd::Arrivals<V> arrivals{&posed, &nearer, 1};
  const auto search = [&](const simd::Seeds& seeds, int segment_depth) {
    std::vector<simd::FoundPoint> best(std::size_t{1} << segment_depth, {simd::kNone, 0.0f, {}});
    kernels.find_deepest(posed, tree, seeds, segment_depth, margin, {}, best.data());
    hash.add_all(best.data(), best.size());
    std::vector<simd::FoundPoint> arriving(best.size(), {simd::kNone, 0.0f, {}});
    kernels.find_deepest(posed, tree, seeds, segment_depth, margin, arrivals, arriving.data());
    hash.add_all(arriving.data(), arriving.size());
    simd::ManifoldSearch chosen{};
    simd::FoundPoint found = best[0];
    while (found.id != simd::kNone && chosen.count < 3) {
      std::copy_n(found.point, 3, chosen.chosen[chosen.count++]);
      found = kernels.find_widest(posed, tree, seeds, chosen, margin);
      hash.add(found);
    }
  };
  nodes.bound[0] = -std::numeric_limits<float>::infinity();
  for (int level = 0; level < tree.level_count; ++level) {
    if (nodes.count <= simd::kMostSeeds) {
      search({nodes, level}, 0);
      search({nodes, level}, std::min(4, static_cast<int>(tree.depth)));
    }
    next.count = 0;
    kernels.expand(posed, tree, level, nodes, next, margin, level % 2 == 0 ? 0.0f : 0.001f);
    hash.add_all(next.index, next.count);
    hash.add_all(next.tag, next.count);
    hash.add_all(next.bound, next.count);
    std::swap(nodes, next);
  }
  simd::PointList sifted = room.points(1);
  kernels.sift(posed, tree, nodes, margin, 0.0f, sifted);
  hash.add_all(sifted.id, sifted.count);
  hash.add_all(sifted.tag, sifted.count);
  simd::PointList points = room.points();
  kernels.evaluate_sifted(posed, sifted, margin, points);
  hash.add_all(points.id, points.count);
  hash.add_all(points.tag, points.count);
  hash.add_all(points.distance, points.count);
  points.count = 0;
  kernels.evaluate(posed, tree, nodes, margin, points);
  hash.add_all(points.id, points.count);
  hash.add_all(points.distance, points.count);
  point_count = points.count;
  simd::NodeList slots = nodes;
  kernels.keep_arriving_spheres(arrivals, tree, tree.level_count - 1, 0.0f, slots);
  hash.add_all(slots.index, slots.count);
  kernels.keep_arriving_points(arrivals, 0.0f, sifted);
  hash.add_all(sifted.id, sifted.count);
  if (points.count > 0) {
    std::vector<Contact> contacts(points.count);
    kernels.complete(posed, tree, points, contacts.data());
    hash.add_all(contacts.data(), contacts.size());
    kernels.differentiate(posed, points, 0.01f, room.gradient(0), room.gradient(1),
                          room.gradient(2));
    for (std::size_t axis = 0; axis < 3; ++axis) hash.add_all(room.gradient(axis), points.count);
  }

  hash.add(kernels.find_any(posed, tree, margin));
  return hash.value();
}

TEST(QueryKernels, SiftLeavesOutPointsThatDoNotComeIn) {
  Random random(251);
  QueryScratch scratch;
  QueryScratch::State& state = scratch.state();
  std::uint32_t walked = 0;
  std::uint32_t sifted = 0;
  std::uint32_t needed = 0;
  for (const PointShell& shell : shells()) {
    for (const Field& field : fields()) {
      for (int i = 0; i < 20; ++i) {
        const Pose pose = make_pose_at(field, shell, random.uniform(-0.05, 0.02), random);
        with_posed(field, shell, pose, [&]<class V>(const simd::PosedView<V>& posed) {
          constexpr float kGrowth = 0.0005f;
          const simd::QueryKernels<V>& kernels = simd::query_kernels<V>(simd::active_isa());
          const simd::TreeView tree = view_tree(shell);
          Room room(shell);
          state.reserve(tree);
          simd::NodeList nodes = walk_down(posed, tree, 0.0f, kGrowth, SphereBounds::kUnwanted,
                                           state, [](const simd::Seeds&) { return true; })
                                     .nodes;
          walked += 8 * nodes.count;
          simd::PointList left = room.points(1);
          kernels.sift(posed, tree, nodes, 0.0f, kGrowth, left);
          sifted += left.count;
          Pose moved = pose;
          moved.translation += 0.99 * static_cast<double>(kGrowth) * random.direction();
          with_posed(field, shell, moved, [&]<class W>(const simd::PosedView<W>& posed_then) {
            if constexpr (std::is_same_v<V, W>) {
              simd::PointList points = room.points();
              kernels.evaluate(posed_then, tree, nodes, 0.0f, points);
              const std::vector<std::uint32_t> ids(points.id, points.id + points.count);
              needed += points.count;
              points.count = 0;
              kernels.evaluate_sifted(posed_then, left, 0.0f, points);
              EXPECT_EQ(std::vector(points.id, points.id + points.count), ids);
            }
          });
        });
      }
    }
  }
  EXPECT_GT(needed, 1'000u);
  EXPECT_LT(sifted, 0.8 * walked);
}

TEST(QueryKernels, WriteTheSameBitsOnEveryInstructionSet) {
  if (simd::active_isa() == simd::Isa::kPortable) GTEST_SKIP() << "there is one only";
  Random random(250);
  int with_points = 0;
  int poses = 0;
  for (const PointShell& shell : shells()) {
    for (const Field& field : fields()) {
      for (int i = 0; i < 20; ++i) {
        const Pose pose = make_pose_at(field, shell, random.uniform(-0.2, 0.1), random);
        const float margin = i % 3 == 0 ? 0.02f : i % 3 == 1 ? 0.0f : -0.01f;
        with_posed(field, shell, pose, [&](const auto& posed) {
          std::size_t points = 0;
          const std::uint64_t portable =
              hash_kernels(simd::Isa::kPortable, posed, shell, margin, points);
          const std::uint64_t active =
              hash_kernels(simd::active_isa(), posed, shell, margin, points);
          EXPECT_EQ(portable, active) << "field " << field.index();
          ++poses;
          with_points += points > 0;
        });
      }
    }
  }
  EXPECT_GT(with_points, 0.4 * poses);
}

}  // namespace
}  // namespace voxshell::query_kernels_test
