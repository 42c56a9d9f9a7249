#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "voxshell/contacts.h"

namespace voxshell::bullet {

/// The place that a body at rest lies on, remembered from step to step.
///
/// Bodies that have come to rest lie on points that are not all in touch to the last micrometer:
/// taken as they are, points change from step to step, and a body tips from one set to the next
/// for ever. So points that are nearly as near as the nearest count as just as near, and those
/// that carried the body before are pulled back to where they did. Decision 52.
class RestingPatch {
 public:
  /// Moves the depths of `contacts` that are in the patch.
  ///
  /// @param contacts   Ascending by id; not empty.
  /// @param exact      Ids, ascending, of those that are no samples: they keep their depths.
  /// @param thickness  Of Bullet's margins, which add to the depths, meters.
  /// @param band       How much farther from the surface than the nearest points may be, meters.
  void settle(std::span<Contact> contacts, std::span<const std::uint32_t> exact, double thickness,
              double band);

  /// Forgets all points but these, which the body lies on.
  void keep(std::span<const Contact> contacts);

  /// For bodies that move.
  void release();

 private:
  void drop_exact(std::span<const std::uint32_t> exact);

  struct Held {
    std::uint32_t id;
    std::uint32_t place;  ///< in the list of contacts that it was found in
    double lift;          ///< how much farther from the surface than the nearest, meters
  };

  std::vector<Held> held_;
  std::vector<double> lifts_;  ///< of all contacts of a step, and room for more
};

}  // namespace voxshell::bullet
