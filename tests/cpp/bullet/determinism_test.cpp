#include <cstdint>
#include <cstring>

#include <gtest/gtest.h>

#include "support/models.h"
#include "support/world.h"

namespace voxshell::bullet {
namespace {

using namespace test_support;

/// FNV-1a over the bits of all transforms after every step.
std::uint64_t hash_of_pile(ContactMode mode, double nudge) {
  TestWorld world({.mode = mode});
  world.add_model(slab_model(), 0).setFriction(1);
  const std::shared_ptr<const Model> models[] = {cube_model(), blob_model(), torus_model(),
                                                 ball_model(), blob_model()};
  std::vector<const btRigidBody*> bodies;
  for (int i = 0; i < 5; ++i) {
    btRigidBody& body = world.add_model(models[i], 1 + i,
                                        {{}, {0.03 * i + nudge, 0.02 * (i % 2), 0.15 + 0.25 * i}});
    body.setFriction(scalar(0.5));
    body.setRestitution(scalar(0.3));
    bodies.push_back(&body);
  }
  std::uint64_t hash = 0xcbf29ce484222325u;
  for (int i = 0; i < 500; ++i) {
    world.step(1);
    for (const btRigidBody* body : bodies) {
      const btTransform& t = body->getWorldTransform();
      for (int k = 0; k < 12; ++k) {
        const btScalar value = k < 3 ? t.getOrigin()[k] : t.getBasis()[k / 3 - 1][k % 3];
        unsigned char bytes[sizeof(btScalar)];
        std::memcpy(bytes, &value, sizeof(bytes));
        for (const unsigned char byte : bytes) hash = (hash ^ byte) * 0x100000001b3u;
      }
    }
  }
  return hash;
}

TEST(Determinism, APileFallsTheSameWayTwice) {
  for (const ContactMode mode : {ContactMode::kRegular, ContactMode::kSegmented}) {
    const std::uint64_t first = hash_of_pile(mode, 0.0);
    EXPECT_EQ(first, hash_of_pile(mode, 0.0));
    EXPECT_NE(first, hash_of_pile(mode, 1e-5));  // the hash does see the poses
  }
}

}  // namespace
}  // namespace voxshell::bullet
