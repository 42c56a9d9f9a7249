#pragma once

// What the fuzz targets of model files have in common. libFuzzer's mutator starts from a real file,
// changes it, and gives it a checksum that fits, so that changes get past the checksum.

#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <memory>

#include "support/meshes.h"
#include "support/model_bytes.h"

namespace voxshell::fuzz {

inline const Model& small_model() {
  static const auto* model = new std::shared_ptr<const Model>(
      *Model::build(test_support::make_l_shape(0.1).mesh(),
                    {.voxel_size = 0.05, .target_points = 100, .padding = 0.0}));
  return **model;
}

/// The model in the file, or none; ends the program where the error is not the one that readers of
/// damaged files are promised.
inline std::shared_ptr<const Model> read_tampered(const std::uint8_t* data, std::size_t size) {
  const auto* begin = reinterpret_cast<const std::byte*>(data);
  auto model = test_support::from_bytes({begin, begin + size});
  if (model) return *std::move(model);
  if (model.error().code != ErrorCode::kInvalidFile) std::abort();
  return nullptr;
}

}  // namespace voxshell::fuzz

extern "C" std::size_t LLVMFuzzerMutate(std::uint8_t* data, std::size_t size, std::size_t most);

extern "C" std::size_t LLVMFuzzerCustomMutator(std::uint8_t* data, std::size_t size,
                                               std::size_t most, unsigned /*seed*/) {
  using namespace voxshell;
  static const test_support::FileBytes whole = test_support::to_bytes(fuzz::small_model());
  if (most < whole.size()) std::abort();  // -max_len must hold a file
  if (size < whole.size()) {
    std::memcpy(data, whole.data(), whole.size());
    size = whole.size();
  }
  size = LLVMFuzzerMutate(data, size, most);
  if (size < sizeof(model_format::Header)) return size;
  const auto* begin = reinterpret_cast<const std::byte*>(data);
  test_support::FileBytes bytes(begin, begin + size);
  test_support::fix_checksum(bytes);
  std::memcpy(data, bytes.data(), size);
  return size;
}
