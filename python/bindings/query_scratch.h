#pragma once

#include <mutex>
#include <optional>

#include "voxshell/contacts.h"
#include "voxshell/pair.h"

namespace voxshell::python {

/// What `scratch=` takes: one QueryScratch for each body's shell, so that a query of both begins
/// where each of them ended.
struct SharedScratch {
  std::mutex mutex;
  QueryScratch of_a;
  QueryScratch of_b;
};

/// The caller's scratch for one query, locked; or, where there is none, one of its own. Without the
/// GIL, or a thread that waits would keep the one that works from ending.
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
