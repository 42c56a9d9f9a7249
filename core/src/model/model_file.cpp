#include "voxshell/model_file.h"

#include <algorithm>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "base/file.h"
#include "model/read_model.h"
#include "model/write_model.h"

namespace voxshell {

Result<std::monostate> save_model(const Model& model, const std::string& path) {
  auto file = OutputFile::create(path);
  if (!file) return file.error();
  auto written =
      write_model(model, [&](std::span<const std::byte> bytes) { return file->append(bytes); });
  if (!written) return written;
  return file->commit();
}

Result<std::shared_ptr<const Model>> load_model(const std::string& path,
                                                std::uint64_t memory_limit) {
  const auto file = InputFile::open(path);
  if (!file) return file.error();
  auto model = read_model(
      file->size(), memory_limit,
      [&](std::uint64_t offset, std::span<std::byte> bytes) { return file->read(offset, bytes); });
  if (model) return model;
  return Error{model.error().code, path + ": " + model.error().message};
}

std::vector<std::byte> model_to_bytes(const Model& model) {
  std::vector<std::byte> bytes;
  // Taking bytes in cannot fail.
  (void)write_model(model, [&](std::span<const std::byte> next) -> Result<std::monostate> {
    bytes.insert(bytes.end(), next.begin(), next.end());
    return std::monostate{};
  });
  return bytes;
}

Result<std::shared_ptr<const Model>> model_from_bytes(std::span<const std::byte> bytes,
                                                      std::uint64_t memory_limit) {
  return read_model(bytes.size(), memory_limit,
                    [&](std::uint64_t offset, std::span<std::byte> part) -> Result<std::monostate> {
                      std::ranges::copy(bytes.subspan(offset, part.size()), part.begin());
                      return std::monostate{};
                    });
}

}  // namespace voxshell
