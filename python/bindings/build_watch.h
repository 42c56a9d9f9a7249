#pragma once

#include <exception>
#include <string_view>

#include <nanobind/nanobind.h>

#include "interpreter_lock.h"
#include "voxshell/ordinary_floats.h"

namespace voxshell::python {

/// The progress callback of a build that runs without the GIL. Each report takes the GIL, lets
/// Python handle signals (Ctrl-C) and calls `callback` unless it is None. Whatever they raise stops
/// the build and waits for rethrow().
class BuildWatch {
 public:
  explicit BuildWatch(nanobind::handle callback) : callback_(callback) {}

  bool report(std::string_view stage, double fraction) {
    if (raised_ != nullptr) return false;
    const TakenInterpreter taken;
    const OrdinaryFloats floats;  // Python code may change the state, but the build needs it
    try {
      if (PyErr_CheckSignals() != 0) throw nanobind::python_error();
      if (!callback_.is_none()) {
        callback_(nanobind::str(stage.data(), stage.size()), fraction);
      }
    } catch (...) {
      raised_ = std::current_exception();
    }
    return raised_ == nullptr;
  }

  /// Rethrows the exception, if there was one. Needs the GIL.
  void rethrow() const {
    if (raised_ != nullptr) std::rethrow_exception(raised_);
  }

 private:
  nanobind::handle callback_;
  std::exception_ptr raised_;
};

}  // namespace voxshell::python
