#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include "voxshell/model.h"
#include "voxshell/result.h"

namespace voxshell {

/// Writes a model to a file: a header, a table and the model's arrays, little-endian, with a
/// checksum. The file appears completely or not at all, and replaces a file of the same name. The
/// same model gives the same bytes. Errors: kFileAccess.
Result<std::monostate> save_model(const Model& model, const std::string& path);

/// Reads a file of save_model(). Whatever the file holds, a model that is returned is valid: every
/// index is in range, and every number is finite. The reader trusts the distances (decision 0008).
/// Takes a few milliseconds. Errors: kFileAccess; kInvalidFile (damaged, or of another kind or
/// version); kTooLarge (more than `memory_limit` bytes, or more than are available).
Result<std::shared_ptr<const Model>> load_model(const std::string& path,
                                                std::uint64_t memory_limit = std::uint64_t{4}
                                                                             << 30);

/// The bytes of the file that save_model() writes.
std::vector<std::byte> model_to_bytes(const Model& model);

/// load_model() for bytes in memory.
Result<std::shared_ptr<const Model>> model_from_bytes(std::span<const std::byte> bytes,
                                                      std::uint64_t memory_limit = std::uint64_t{4}
                                                                                   << 30);

}  // namespace voxshell
