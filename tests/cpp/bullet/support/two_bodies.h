#pragma once

#include <vector>

#include <BulletCollision/CollisionDispatch/btCollisionObjectWrapper.h>

#include "pair_step.h"
#include "posed_pair.h"
#include "support/world.h"
#include "voxshell/contacts.h"
#include "wrap_object.h"

namespace voxshell::bullet::test_support {

/// Two bodies of a world as a pair that is about to step.
struct TwoBodies {
  TwoBodies(const btRigidBody& a, const btRigidBody& b, ShellRule rule = ShellRule::kAutomatic)
      : wrap_a(wrap_object(a)), wrap_b(wrap_object(b)), pair(wrap_a, wrap_b, nullptr, rule) {}

  PairStep step(double time_step = 1.0 / 200.0, const ContactSettings& settings = {}) const {
    return describe_step(pair, settings, time_step, 0.0);
  }

  /// The points of the pair's shell within a margin of its field, meters.
  std::vector<Contact> near(double margin) const {
    QueryScratch scratch;
    const auto found = find_contacts(pair.field(), pair.shell(), pair.field_from_shell(),
                                     {.margin = static_cast<float>(margin)}, scratch);
    return {found.begin(), found.end()};
  }

  btCollisionObjectWrapper wrap_a;
  btCollisionObjectWrapper wrap_b;
  PosedPair pair;
};

}  // namespace voxshell::bullet::test_support
