// As model_file.cpp, without queries: reading alone, several times as often.
//
//     cmake --preset fuzz && cmake --build --preset fuzz
//     build/fuzz/fuzz/voxshell_fuzz_model_parsing -max_len=200000 -max_total_time=60

#include "tampered_model.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  voxshell::fuzz::read_tampered(data, size);
  return 0;
}
