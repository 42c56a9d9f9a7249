// Model files that somebody has tampered with: refused with a typed error, or models whose queries
// read nothing beyond them.
//
//     cmake --preset fuzz && cmake --build --preset fuzz
//     build/fuzz/fuzz/voxshell_fuzz_model_file -max_len=200000 -max_total_time=60

#include "tampered_model.h"
#include "voxshell/contacts.h"

using namespace voxshell;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto model = fuzz::read_tampered(data, size);
  if (!model) return 0;
  static QueryScratch scratch;
  const Pose pose{{{1, 0, 0}, {0, 0.6, -0.8}, {0, 0.8, 0.6}}, {0.05, -0.02, 0.03}};
  constexpr float kMargin = 0.1f;  // meters: nearly all points
  find_contacts(model->field(), fuzz::small_model().shell(), pose, {.margin = kMargin}, scratch);
  find_contacts(fuzz::small_model().field(), model->shell(), pose, {.margin = kMargin}, scratch);
  return 0;
}
