// A program of its own, as it replaces the allocation functions of all of it.
#include <algorithm>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <new>
#include <vector>

#include <gtest/gtest.h>

#include "support/pairs.h"
#include "support/random.h"
#include "voxshell/contacts.h"
#include "voxshell/manifold.h"
#include "voxshell/sweep.h"
#include "voxshell/wrench.h"

namespace {

std::atomic<std::size_t> allocation_count{0};
std::atomic<std::size_t> failing_allocation{0};  ///< counted as above; 0: none fails

void count() {
  if (++allocation_count == failing_allocation) throw std::bad_alloc();
}

void* allocate(std::size_t size) {
  count();
  if (void* memory = std::malloc(size == 0 ? 1 : size)) return memory;
  throw std::bad_alloc();
}

void* allocate(std::size_t size, std::align_val_t alignment) {
  count();
  const auto align = static_cast<std::size_t>(alignment);
  if (void* memory = std::aligned_alloc(align, (size + align - 1) / align * align)) return memory;
  throw std::bad_alloc();
}

}  // namespace

void* operator new(std::size_t size) { return allocate(size); }
void* operator new[](std::size_t size) { return allocate(size); }
void* operator new(std::size_t size, const std::nothrow_t&) noexcept {
  if (++allocation_count == failing_allocation) return nullptr;
  return std::malloc(size == 0 ? 1 : size);
}
void* operator new[](std::size_t size, const std::nothrow_t& tag) noexcept {
  return operator new(size, tag);
}
void* operator new(std::size_t size, std::align_val_t align) { return allocate(size, align); }
void* operator new[](std::size_t size, std::align_val_t align) { return allocate(size, align); }
void operator delete(void* memory) noexcept { std::free(memory); }
void operator delete[](void* memory) noexcept { std::free(memory); }
void operator delete(void* memory, std::size_t) noexcept { std::free(memory); }
void operator delete[](void* memory, std::size_t) noexcept { std::free(memory); }
void operator delete(void* memory, std::align_val_t) noexcept { std::free(memory); }
void operator delete[](void* memory, std::align_val_t) noexcept { std::free(memory); }
void operator delete(void* memory, std::size_t, std::align_val_t) noexcept { std::free(memory); }
void operator delete[](void* memory, std::size_t, std::align_val_t) noexcept { std::free(memory); }

namespace voxshell::allocation_test {
namespace {

using namespace test_support;

/// The last has edges.
std::vector<PointShell> shells_some_with_edges() {
  std::vector<PointShell> all = shells();
  all.push_back(*PointShell::build(make_l_shape(0.3).mesh(), {.tolerance = 2e-3}));
  return all;
}

TEST(Allocation, IsCounted) {
  const std::size_t before = allocation_count;
  const std::vector<int> some(1000);
  EXPECT_EQ(some.size(), 1000u);
  EXPECT_GT(allocation_count, before);
}

TEST(Allocation, HappensInNoWarmQuery) {
  Random random(130);
  std::vector<PointShell> all = shells_some_with_edges();
  ASSERT_NE(all.back().edges(), nullptr);
  for (const PointShell& shell : all) {
    for (const Field& field : fields()) {
      std::vector<Pose> poses;
      for (int i = 0; i < 50; ++i) {
        poses.push_back(make_pose_at(field, shell, random.uniform(-0.1, 0.05), random));
      }
      QueryScratch scratch;
      std::vector<std::uint32_t> deepest;
      std::size_t contacts = 0;
      const auto ask = [&](const Pose& pose) {
        const auto found = find_contacts(field, shell, pose, {.margin = 0.01f}, scratch);
        const ManifoldPoints manifold = select_manifold(found);
        select_deepest_per_segment(found, shell, 4, deepest);
        contacts += found.size() + manifold.count + deepest.size();
        contacts += collides(field, shell, pose, 0.01f);
        contacts += find_manifold(field, shell, pose, 0.01f, scratch).size();
        const RigidMotion motion{pose, {0.02, 0.01, -0.03}, {0.0, 0.1, 0.0}};
        contacts += sweep(field, shell, {}, motion, {.tolerance = 1e-3}, scratch).contact ? 1u : 0u;
      };
      const std::size_t cold = allocation_count;
      for (const Pose& pose : poses) ask(pose);
      EXPECT_GT(allocation_count, cold);
      contacts = 0;

      const std::size_t warm = allocation_count;
      for (const Pose& pose : poses) ask(pose);
      EXPECT_EQ(allocation_count - warm, 0u);
      EXPECT_GT(contacts, 500u);
    }
  }
}

std::vector<Contact> find_anew(const Field& field, const PointShell& shell, const Pose& pose) {
  QueryScratch scratch;
  const auto found = find_contacts(field, shell, pose, {}, scratch);
  return {found.begin(), found.end()};
}

/// Lets each allocation of the queries fail in turn, and then asks the same scratch about a smaller
/// and about the same shell.
void expect_right_after_failures(const Field& field, const PointShell& small,
                                 const PointShell& large, bool borrows, Random& random) {
  const Pose of_small = make_pose_at(field, small, -0.02, random);
  const Pose of_large = make_pose_at(field, large, -0.02, random);
  const std::vector<Contact> small_contacts = find_anew(field, small, of_small);
  const std::vector<Contact> large_contacts = find_anew(field, large, of_large);
  for (std::size_t number = 1;; ++number) {
    ASSERT_LT(number, 200u);
    QueryLists lists;
    QueryScratch scratch;
    const auto find = [&](const PointShell& shell, const Pose& pose) {
      if (borrows) scratch.borrow(lists);
      return find_contacts(field, shell, pose, {}, scratch);
    };
    bool has_failed = false;
    find(small, of_small);
    failing_allocation = allocation_count + number;
    try {
      // Twice near, then twice the same: each asks for other lists.
      for (const double x : {0.0, 1e-5, 2e-5, 2e-5}) {
        find(large, Pose{{}, {x, 0.0, 0.0}} * of_large);
      }
      find_manifold(field, large, of_large, 0.01f, scratch);
      compute_wrench(field, large, of_large, 1e6, scratch);
    } catch (const std::bad_alloc&) {
      has_failed = true;
    }
    failing_allocation = 0;
    for (int i = 0; i < 2; ++i) {
      EXPECT_TRUE(std::ranges::equal(find(small, of_small), small_contacts)) << number;
      EXPECT_TRUE(std::ranges::equal(find(large, of_large), large_contacts)) << number;
    }
    if (!has_failed) return;
  }
}

TEST(Allocation, ThatFailsLeavesTheScratchUsable) {
  Random random(131);
  std::vector<PointShell> all = shells_some_with_edges();
  ASSERT_NE(all.back().edges(), nullptr);
  std::ranges::sort(all, {}, &PointShell::size);
  for (const Field& field : fields()) {
    for (std::size_t i = 1; i < all.size(); ++i) {
      for (const bool borrows : {false, true}) {
        expect_right_after_failures(field, all[0], all[i], borrows, random);
        if (testing::Test::HasFailure()) return;
      }
    }
  }
}

}  // namespace
}  // namespace voxshell::allocation_test
