#pragma once

#include <string>
#include <utility>

#include <nanobind/nanobind.h>

#include "voxshell/result.h"

namespace voxshell::python {

/// Throws the Python exception of voxshell.errors that stands for an error of the core. The one
/// place where they meet. Needs the GIL.
[[noreturn]] void raise(const Error& error);

/// From now on, exceptions of C++ arrive in Python as those of voxshell.errors.
void translate_exceptions();

/// The value of a result, or its error raised. A `subject` says which argument is meant.
template <class T>
T unwrap(Result<T> result, const char* subject = nullptr) {
  if (result) return *std::move(result);
  if (subject == nullptr) raise(result.error());
  raise({result.error().code, std::string(subject) + ": " + result.error().message});
}

}  // namespace voxshell::python
