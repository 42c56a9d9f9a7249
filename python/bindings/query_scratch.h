#pragma once

#include <mutex>
#include <optional>

#include "voxshell/contacts.h"
#include "voxshell/pair.h"

namespace voxshell::python {

/// The Python class QueryScratch: one scratch for each body's shell, so that a query of both starts
/// where each of them ended.
struct SharedScratch {
  std::mutex mutex;
  QueryScratch of_a;
  QueryScratch of_b;
};

/// The caller's scratch for one query, locked, or a temporary one. Lock it without the GIL:
/// otherwise a waiting thread would block the one that holds the lock.
class LockedScratch {
 public:
  LockedScratch(SharedScratch* shared, PairBody shell_body) {
    if (shared == nullptr) {
      scratch_ = &own_.emplace();
    } else {
      lock_ = std::unique_lock(shared->mutex);
      scratch_ = shell_body == PairBody::kA ? &shared->of_a : &shared->of_b;
    }
  }
  LockedScratch(const LockedScratch&) = delete;
  LockedScratch& operator=(const LockedScratch&) = delete;

  QueryScratch& operator*() const { return *scratch_; }

 private:
  std::optional<QueryScratch> own_;
  std::unique_lock<std::mutex> lock_;
  QueryScratch* scratch_;
};

}  // namespace voxshell::python
