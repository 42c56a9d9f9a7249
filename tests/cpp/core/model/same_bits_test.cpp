#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "support/model_bytes.h"
#include "support/random.h"
#include "support/traveling_models.h"
#include "voxshell/contacts.h"
#include "voxshell/distance.h"
#include "voxshell/field.h"
#include "voxshell/manifold.h"
#include "voxshell/wrench.h"

// Hashes of what models and queries are, the same on every processor, with every compiler and
// instruction set. A change that is meant to give other models or contacts changes them.

namespace voxshell::same_bits_test {
namespace {

using namespace test_support;

/// FNV-1a over words, whatever the order of their bytes.
class Hash {
 public:
  void add(std::uint64_t word) { value_ = (value_ ^ word) * 0x100000001B3u; }
  void add(float value) { add(std::uint64_t{std::bit_cast<std::uint32_t>(value)}); }
  void add(double value) { add(std::bit_cast<std::uint64_t>(value)); }
  template <class T>
  void add(const Vector3<T>& v) {
    add(v.x);
    add(v.y);
    add(v.z);
  }
  void add(const Contact& contact) {
    add(std::uint64_t{contact.id});
    add(contact.depth);
    add(contact.point);
    add(contact.normal);
  }
  std::uint64_t value() const { return value_; }

 private:
  std::uint64_t value_ = 0xCBF29CE484222325u;
};

std::string in_hex(std::uint64_t value) {
  std::string text(16, '0');
  for (std::size_t i = 16; i-- > 0; value >>= 4) text[i] = "0123456789abcdef"[value & 15];
  return text;
}

TEST(SameBits, OfModelFiles) {
  const std::vector<std::string> expected{"a4040b5ba9181306", "cd462db9c3cf1332",
                                          "4e5197bfebcf5497", "2b035d4833bf0d4e",
                                          "0bb073bdb0538d70", "6f42520679bbc673"};
  std::vector<std::string> found;
  for (const auto& [name, model] : traveling_models()) {
    const FileBytes bytes = to_bytes(*model);
    found.push_back(
        in_hex(read_at<std::uint64_t>(bytes, offsetof(model_format::Header, checksum))));
  }
  EXPECT_EQ(found, expected);
}

TEST(SameBits, OfMassProperties) {
  Hash hash;
  for (const auto& [name, model] : traveling_models()) {
    for (const MassProperties& m :
         {model->solid_mass_properties(), model->surface_mass_properties()}) {
      hash.add(m.mass);
      hash.add(m.center_of_mass);
      for (const Vec3& row : {m.inertia.row_x, m.inertia.row_y, m.inertia.row_z}) hash.add(row);
    }
  }
  EXPECT_EQ(in_hex(hash.value()), "e472f05de6254aae");
}

TEST(SameBits, OfSmoothSurfaces) {
  Random random(41);
  Hash hash;
  std::size_t curved = 0;
  for (const auto& [name, model] : traveling_models()) {
    const SmoothSurface& surface = model->smooth_surface();
    curved += surface.is_curved();
    for (int i = 0; i < 50; ++i) {
      const SmoothSurface::Place place = surface.nearest(random.in_cube(0.4));
      hash.add(std::uint64_t{place.triangle});
      hash.add(surface.position(place));
      hash.add(surface.normal(place));
    }
  }
  EXPECT_GT(curved, 2u);
  EXPECT_EQ(in_hex(hash.value()), "0a118088eb957050");
}

TEST(SameBits, OfQueries) {
  std::vector<Field> fields{PlaneField{normalized(Vec3{1, -2, 3}), 0.1},
                            BoxField{{0.2, 0.3, 0.1}},
                            SphereField{0.3},
                            CapsuleField{0.1, 0.3},
                            CylinderField{0.2, 0.4},
                            ConeField{0.3, 0.5}};
  auto convex = ConvexField::create(make_icosphere(0.3, 1).mesh());
  ASSERT_TRUE(convex);
  fields.push_back(*std::move(convex));
  for (const auto& [name, model] : traveling_models()) fields.push_back(model->field());

  Random random(42);
  QueryScratch scratch;
  Hash contacts;
  Hash manifolds;
  Hash nearest;
  Hash wrenches;
  std::size_t count = 0;
  for (const Field& field : fields) {
    for (const auto& [name, model] : traveling_models()) {
      const PointShell& shell = model->shell();
      for (int i = 0; i < 6; ++i) {
        const Pose pose{make_rotation(random), random.in_cube(0.4)};
        for (const Contact& contact :
             find_contacts(field, shell, pose, {.margin = 0.01f}, scratch)) {
          contacts.add(contact);
          ++count;
        }
        for (const Contact& contact :
             find_contacts_within_budget(field, shell, pose, {}, 30, scratch).contacts) {
          contacts.add(contact);
        }
        for (const Contact& contact : find_manifold(field, shell, pose, 0.01f, scratch)) {
          manifolds.add(contact);
        }
        if (const auto contact = find_nearest(field, shell, pose, 10.0f, scratch)) {
          nearest.add(*contact);
        }
        const Wrench wrench = compute_wrench(field, shell, pose, 1e6, scratch);
        wrenches.add(wrench.force);
        wrenches.add(wrench.torque);
      }
    }
  }
  EXPECT_GT(count, 10'000u);
  EXPECT_EQ(in_hex(contacts.value()), "7091a63f5cb99c62");
  EXPECT_EQ(in_hex(manifolds.value()), "4eb64ea0dc477964");
  EXPECT_EQ(in_hex(nearest.value()), "f438c144a37d07fc");
  EXPECT_EQ(in_hex(wrenches.value()), "30f7189bd52bbbaf");
}

}  // namespace
}  // namespace voxshell::same_bits_test
