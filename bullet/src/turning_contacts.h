#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "impact.h"
#include "pair_step.h"
#include "voxshell/contacts.h"

namespace voxshell::bullet {

/// The contacts of a step with which bodies slide or roll along a concave surface, such as a bowl.
/// There, the contact's plane turns toward the bodies as they move. A solver that keeps to the
/// plane of the step's start lets them move into the surface, and the next step takes away the part
/// of their velocity that leads into it: they lose speed in each step. Such contacts end the step
/// with the speed apart with which the bodies stay outside until its end. They arrive at the next
/// one with as much speed together, so nothing is lost. Decision 61.
class TurningContacts {
 public:
  /// @param contacts  Ascending by id.
  /// @param exact     Ids, ascending, of those that are no samples.
  void find(const PairStep& step, std::span<const Contact> contacts,
            std::span<const std::uint32_t> exact);

  /// The speed apart that a contact is to end the step with if it touches now, m/s; 0 where it does
  /// not turn.
  double speed_of(std::uint32_t id) const;

  /// How the bodies move as the contact has them move that turns most: without forces, which others
  /// may carry, and with them. None where no contact turns.
  std::span<const RelativeMotion> motions() const { return motions_; }

 private:
  struct Turning {
    std::uint32_t id;
    Vec3f normal;
    Impact impact;
    std::optional<double> found;  ///< how much nearer the bodies come, meters
    double speed = 0.0;
  };

  void find_motions(const PairStep& step, const Turning& turning);
  std::optional<double> mean_beside(const Vec3f& normal) const;

  std::vector<Turning> turning_;  ///< ascending by id
  std::vector<RelativeMotion> motions_;
};

}  // namespace voxshell::bullet
