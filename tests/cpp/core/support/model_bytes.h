#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <memory>
#include <span>
#include <variant>
#include <vector>

#include "base/checksum.h"
#include "model/model_format.h"
#include "model/read_model.h"
#include "model/write_model.h"
#include "voxshell/model.h"

namespace voxshell::test_support {

/// A model file in memory.
using FileBytes = std::vector<std::byte>;

inline FileBytes to_bytes(const Model& model) {
  FileBytes bytes;
  const auto written = write_model(model, [&](std::span<const std::byte> next) {
    bytes.insert(bytes.end(), next.begin(), next.end());
    return std::monostate{};
  });
  return written ? bytes : FileBytes{};
}

inline Result<std::shared_ptr<const Model>> from_bytes(const FileBytes& bytes,
                                                       std::uint64_t memory_limit = std::uint64_t{1}
                                                                                    << 30) {
  return read_model(bytes.size(), memory_limit,
                    [&](std::uint64_t offset, std::span<std::byte> into) {
                      // A copy, so that the sanitizer sees what is read beyond the end.
                      std::memcpy(into.data(), bytes.data() + offset, into.size());
                      return std::monostate{};
                    });
}

template <class T>
T read_at(const FileBytes& bytes, std::size_t offset) {
  T value;
  std::memcpy(&value, bytes.data() + offset, sizeof value);
  return little_endian(value);
}

template <class T>
void write_at(FileBytes& bytes, std::size_t offset, T value) {
  value = little_endian(value);
  std::memcpy(bytes.data() + offset, &value, sizeof value);
}

/// Makes damage look intended.
inline void fix_checksum(FileBytes& bytes) {
  constexpr std::size_t kFrom = model_format::kChecksumFrom;
  Checksum checksum;
  const std::size_t size = bytes.size() - kFrom;
  checksum.add(std::span(bytes).subspan(kFrom, size / Checksum::kStripe * Checksum::kStripe));
  write_at(bytes, offsetof(model_format::Header, checksum), checksum.value());
}

inline std::size_t table_offset(std::uint32_t kind) {
  return sizeof(model_format::Header) + (kind - 1) * sizeof(model_format::TableEntry);
}

inline model_format::TableEntry table_entry(const FileBytes& bytes, std::uint32_t kind) {
  return read_at<model_format::TableEntry>(bytes, table_offset(kind));
}

}  // namespace voxshell::test_support
