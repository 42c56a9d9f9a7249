// A program of its own, as it replaces the allocation functions of all of it.
#include <atomic>
#include <cstddef>
#include <cstdlib>
#include <memory>
#include <new>
#include <utility>

#include <gtest/gtest.h>

#include "model_memory.h"
#include "support/meshes.h"
#include "support/model_bytes.h"
#include "voxshell/model.h"

namespace {

std::atomic<std::size_t> held{0};  ///< bytes that this program asked for and has not given back

/// Each block begins with its size, in as many bytes as keep the rest aligned.
void* allocate(std::size_t size, std::size_t alignment) {
  const std::size_t whole = (size + 2 * alignment - 1) / alignment * alignment;
  void* block = std::aligned_alloc(alignment, whole);
  if (block == nullptr) throw std::bad_alloc();
  *static_cast<std::size_t*>(block) = size;
  held += size;
  return static_cast<std::byte*>(block) + alignment;
}

void release(void* memory, std::size_t alignment) {
  if (memory == nullptr) return;
  void* block = static_cast<std::byte*>(memory) - alignment;
  held -= *static_cast<std::size_t*>(block);
  std::free(block);
}

constexpr std::size_t kDefault = __STDCPP_DEFAULT_NEW_ALIGNMENT__;

std::size_t number(std::align_val_t alignment) { return static_cast<std::size_t>(alignment); }

}  // namespace

void* operator new(std::size_t size) { return allocate(size, kDefault); }
void* operator new[](std::size_t size) { return allocate(size, kDefault); }
// Sanitizers have their own of these.
void* operator new(std::size_t size, const std::nothrow_t&) noexcept {
  return allocate(size, kDefault);
}
void* operator new[](std::size_t size, const std::nothrow_t&) noexcept {
  return allocate(size, kDefault);
}
void* operator new(std::size_t size, std::align_val_t a) { return allocate(size, number(a)); }
void* operator new[](std::size_t size, std::align_val_t a) { return allocate(size, number(a)); }
void operator delete(void* memory) noexcept { release(memory, kDefault); }
void operator delete[](void* memory) noexcept { release(memory, kDefault); }
void operator delete(void* memory, std::size_t) noexcept { release(memory, kDefault); }
void operator delete[](void* memory, std::size_t) noexcept { release(memory, kDefault); }
void operator delete(void* memory, std::align_val_t a) noexcept { release(memory, number(a)); }
void operator delete[](void* memory, std::align_val_t a) noexcept { release(memory, number(a)); }
void operator delete(void* memory, std::size_t, std::align_val_t a) noexcept {
  release(memory, number(a));
}
void operator delete[](void* memory, std::size_t, std::align_val_t a) noexcept {
  release(memory, number(a));
}

namespace voxshell::memory_test {
namespace {

using benchmarks::compute_memory;

constexpr std::size_t kObjects = 4096;  // the model itself and what its shared pointer keeps

std::shared_ptr<const Model> build(const test_support::Soup& soup) {
  auto mesh = TriangleMesh::create(soup.vertices, soup.triangles);
  if (!mesh) std::abort();
  auto model = Model::build(*std::move(mesh), {.resolution = 60, .target_points = 5000});
  if (!model) std::abort();
  return *std::move(model);
}

TEST(ModelMemory, OfABuiltModelIsThatOfItsParts) {
  const auto soup = test_support::make_blob(0.35, 5);
  build(soup);  // what libraries keep for ever
  const std::size_t before = held;
  const auto model = build(soup);
  EXPECT_LE(held - before, compute_memory(*model).total() + kObjects);
  EXPECT_GE(held - before, compute_memory(*model).total());
}

TEST(ModelMemory, OfALoadedModelIsThatOfItsParts) {
  const auto bytes = test_support::to_bytes(*build(test_support::make_blob(0.35, 5)));
  const std::size_t before = held;
  const auto model = test_support::from_bytes(bytes);
  ASSERT_TRUE(model);
  EXPECT_LE(held - before, compute_memory(**model).total() + kObjects);
  EXPECT_GE(held - before, compute_memory(**model).total());
}

}  // namespace
}  // namespace voxshell::memory_test
