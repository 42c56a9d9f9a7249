#pragma once

#include <BulletCollision/CollisionDispatch/btCollisionObjectWrapper.h>

#include "pair_step.h"
#include "posed_pair.h"
#include "support/world.h"

namespace voxshell::bullet::test_support {

/// Two bodies of a world as a pair that is about to step.
struct TwoBodies {
  TwoBodies(const btRigidBody& a, const btRigidBody& b, ShellRule rule = ShellRule::kAutomatic)
      : wrap_a(nullptr, a.getCollisionShape(), &a, a.getWorldTransform(), -1, -1),
        wrap_b(nullptr, b.getCollisionShape(), &b, b.getWorldTransform(), -1, -1),
        pair(wrap_a, wrap_b, nullptr, rule) {}

  PairStep step(double time_step = 1.0 / 200.0, const ContactSettings& settings = {}) const {
    return describe_step(pair, settings, time_step, 0.0);
  }

  btCollisionObjectWrapper wrap_a;
  btCollisionObjectWrapper wrap_b;
  PosedPair pair;
};

}  // namespace voxshell::bullet::test_support
