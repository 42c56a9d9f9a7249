#pragma once

#include <cstdint>

namespace voxshell {

/// While one lives, its thread rounds to nearest, keeps denormal numbers and does not trap, which
/// is the state in which results are the same bits everywhere. Then the thread is in the state that
/// was found again, flags included. Costs about 12 ns.
class OrdinaryFloats {
 public:
  OrdinaryFloats();
  ~OrdinaryFloats();
  OrdinaryFloats(const OrdinaryFloats&) = delete;
  OrdinaryFloats& operator=(const OrdinaryFloats&) = delete;

 private:
  std::uint64_t found_;
};

}  // namespace voxshell
