#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <variant>

#include "voxshell/model.h"
#include "voxshell/result.h"

namespace voxshell {

/// Fills a span from a place in a file; both lie within its size.
using ReadAt = std::function<Result<std::monostate>(std::uint64_t, std::span<std::byte>)>;

/// A model from a file of `size` bytes, wherever it is; see load_model().
Result<std::shared_ptr<const Model>> read_model(std::uint64_t size, std::uint64_t memory_limit,
                                                const ReadAt& read_at);

}  // namespace voxshell
