#pragma once

#include <nanobind/nanobind.h>

#if defined(__GLIBCXX__) && defined(__GLIBC__)
#include <cxxabi.h>
#include <unistd.h>
#endif

namespace voxshell::python {

/// Calls `take`, which takes the GIL. At the end of a program, Python up to 3.13 ends a thread that
/// asks for the GIL, and glibc ends it by unwinding its stack. That would end the process, because
/// no exception may leave a destructor. Such a thread now waits for the end instead, as Python 3.14
/// has it wait.
template <class Take>
void take_interpreter(const Take& take) noexcept {
#if defined(__GLIBCXX__) && defined(__GLIBC__)
  try {
    take();
  } catch (const abi::__forced_unwind&) {
    for (;;) pause();
  }
#else
  take();
#endif
}

/// Releases the GIL for a scope.
class ReleasedInterpreter {
 public:
  ReleasedInterpreter() : state_(PyEval_SaveThread()) {}
  ~ReleasedInterpreter() {
    take_interpreter([this] { PyEval_RestoreThread(state_); });
  }
  ReleasedInterpreter(const ReleasedInterpreter&) = delete;
  ReleasedInterpreter& operator=(const ReleasedInterpreter&) = delete;

 private:
  PyThreadState* state_;
};

/// Takes the GIL for a scope, in which a thread may run that Python has not started.
class TakenInterpreter {
 public:
  TakenInterpreter() {
    take_interpreter([this] { state_ = PyGILState_Ensure(); });
  }
  ~TakenInterpreter() { PyGILState_Release(state_); }
  TakenInterpreter(const TakenInterpreter&) = delete;
  TakenInterpreter& operator=(const TakenInterpreter&) = delete;

 private:
  PyGILState_STATE state_{};
};

}  // namespace voxshell::python
