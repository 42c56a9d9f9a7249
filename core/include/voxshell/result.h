#pragma once

#include <cassert>
#include <string>
#include <utility>
#include <variant>

namespace voxshell {

/// The kind of bad input or interruption that stopped an operation.
enum class ErrorCode {
  kInvalidArgument,  ///< a setting is missing, contradictory or out of range
  kInvalidMesh,      ///< the mesh cannot be used: not finite, empty, open, inside out
  kInvalidPose,      ///< a pose is not finite or not a rigid transform
  kTooLarge,         ///< the request would exceed the memory limit
  kCanceled,         ///< the progress callback asked to stop
  kInvalidFile,      ///< a file is damaged, or of another kind or version
  kFileAccess,       ///< a file cannot be opened, read or written
};

/// Describes invalid input: what is wrong, by how much, where, and what to do.
struct Error {
  ErrorCode code;
  std::string message;
};

/// A value or the Error that prevented it. The core never throws.
template <class T>
class [[nodiscard]] Result {
 public:
  Result(T value) : state_(std::move(value)) {}
  Result(Error error) : state_(std::move(error)) {}

  bool has_value() const { return std::holds_alternative<T>(state_); }
  explicit operator bool() const { return has_value(); }

  /// The value; calling these on an error is a programming mistake.
  T& operator*() & { return *checked(); }
  const T& operator*() const& { return *const_cast<Result*>(this)->checked(); }
  T&& operator*() && { return std::move(*checked()); }
  T* operator->() { return checked(); }
  const T* operator->() const { return const_cast<Result*>(this)->checked(); }

  const Error& error() const {
    assert(!has_value());
    return *std::get_if<Error>(&state_);
  }

 private:
  T* checked() {
    assert(has_value());
    return std::get_if<T>(&state_);
  }

  std::variant<T, Error> state_;
};

}  // namespace voxshell
