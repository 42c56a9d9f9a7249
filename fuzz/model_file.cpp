// Model files that somebody has tampered with: refused with a typed error, or models whose queries
// read nothing beyond them. Changes start from a real file and get a checksum that fits.
//
//     cmake --preset fuzz && cmake --build --preset fuzz
//     build/fuzz/fuzz/voxshell_fuzz_model_file -max_len=200000 -max_total_time=60

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <cstring>

#include "support/meshes.h"
#include "support/model_bytes.h"
#include "voxshell/contacts.h"

using namespace voxshell;

namespace {

const Model& small_model() {
  static const auto* model = new std::shared_ptr<const Model>(
      *Model::build(test_support::make_l_shape(0.1).mesh(),
                    {.voxel_size = 0.05, .target_points = 100, .padding = 0.0}));
  return **model;
}

}  // namespace

extern "C" std::size_t LLVMFuzzerMutate(std::uint8_t* data, std::size_t size, std::size_t most);

extern "C" std::size_t LLVMFuzzerCustomMutator(std::uint8_t* data, std::size_t size,
                                               std::size_t most, unsigned /*seed*/) {
  static const test_support::FileBytes whole = test_support::to_bytes(small_model());
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

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto* begin = reinterpret_cast<const std::byte*>(data);
  const auto model = test_support::from_bytes({begin, begin + size});
  if (!model) return model.error().code == ErrorCode::kInvalidFile ? 0 : (std::abort(), 0);
  static QueryScratch scratch;
  const Pose pose{{{1, 0, 0}, {0, 0.6, -0.8}, {0, 0.8, 0.6}}, {0.05, -0.02, 0.03}};
  constexpr float kMargin = 0.1f;  // metres: nearly all points
  find_contacts((*model)->field(), small_model().shell(), pose, {.margin = kMargin}, scratch);
  find_contacts(small_model().field(), (*model)->shell(), pose, {.margin = kMargin}, scratch);
  return 0;
}
