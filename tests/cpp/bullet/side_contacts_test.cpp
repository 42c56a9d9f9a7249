#include "side_contacts.h"

#include <gtest/gtest.h>

#include "support/models.h"
#include "support/two_bodies.h"

namespace voxshell::bullet::side_contacts_test {
namespace {

using namespace test_support;

/// A box of Bullet's, smaller than the slab that it stands on, sunk into it by 1 mm.
struct BoxOnSlab {
  TestWorld world;
  btRigidBody& slab = world.add_model(slab_model(), 0);
  btRigidBody& box =
      world.add(world.make<btBoxShape>(to_bullet(Vec3{0.05, 0.05, 0.05})), 1, {{}, {0, 0, 0.049}});
  TwoBodies bodies{slab, box};
  PairStep step = bodies.step();

  /// A contact of the slab's point that is nearest to a place of its top.
  Contact at(const Vec3f& place, const Vec3f& normal) const {
    const PointShell& shell = slab_model()->shell();
    Contact contact{0, 0.001f, {}, normal};
    float least = 1.0f;
    for (std::uint32_t id = 0; id < shell.size(); ++id) {
      const Vec3f point = shell.points()[id];
      if (shell.normals()[id].z < 0.9f || !(length(point - place) < least)) continue;
      least = length(point - place);
      contact.id = id;
      contact.point = point;
    }
    return contact;
  }
};

TEST(SideContacts, OfAGroundUnderABoxAreNotBeside) {
  const BoxOnSlab scene;
  const Contact below = scene.at({0.02f, 0, 0}, {0, 0, -1});
  EXPECT_FALSE(is_beside(scene.step, below, below.normal));
}

// In front of a box that slides, they stopped it.
TEST(SideContacts, OfAGroundInFrontOfABoxAreBeside) {
  const BoxOnSlab scene;
  const Contact beside = scene.at({0.05f, 0, 0}, {-1, 0, 0});
  EXPECT_TRUE(is_beside(scene.step, beside, beside.normal));
}

}  // namespace
}  // namespace voxshell::bullet::side_contacts_test
