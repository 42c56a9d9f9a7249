#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <map>
#include <vector>

#include <gtest/gtest.h>

#include "support/flat_loop.h"
#include "support/pairs.h"
#include "support/random.h"
#include "voxshell/contacts.h"
#include "voxshell/contacts_flat.h"
#include "voxshell/distance.h"
#include "voxshell/wrench.h"

namespace voxshell::contacts_on_edges_test {
namespace {

using namespace test_support;

constexpr double kEighthTurn = 0.7853981633974483;  // radians

PointShell make_exact_shell(const Soup& soup, double tolerance) {
  auto shell = PointShell::build(soup.mesh(), {.tolerance = tolerance});
  if (!shell) std::abort();
  return *std::move(shell);
}

/// About a meter: boxes, blades and facets that are edges all over; one rounded body.
const std::vector<PointShell>& edgy_shells() {
  static const auto* all = new std::vector<PointShell>{
      make_exact_shell(make_l_shape(0.3), 4e-3), make_exact_shell(make_wedge(0.8, 0.05, 0.4), 4e-3),
      make_exact_shell(make_icosphere(0.4, 1), 4e-3), make_exact_shell(make_spike(0.3, 0.8), 1e-2)};
  return *all;
}

Matrix3 turn_about_x(double angle) {
  const double c = std::cos(angle);
  const double s = std::sin(angle);
  return {{1, 0, 0}, {0, c, -s}, {0, s, c}};
}

Matrix3 turn_about_y(double angle) {
  const double c = std::cos(angle);
  const double s = std::sin(angle);
  return {{c, 0, s}, {0, 1, 0}, {-s, 0, c}};
}

Matrix3 turn_about_z(double angle) {
  const double c = std::cos(angle);
  const double s = std::sin(angle);
  return {{c, -s, 0}, {s, c, 0}, {0, 0, 1}};
}

std::size_t count_on_edges(std::span<const Contact> contacts, const PointShell& shell) {
  return static_cast<std::size_t>(std::count_if(
      contacts.begin(), contacts.end(), [&](const Contact& c) { return !shell.is_point(c.id); }));
}

TEST(ContactsOnEdges, OfEveryFastPathAreThoseOfTheFlatLoopToTheBit) {
  Random random(180);
  QueryScratch scratch;
  QueryScratch other;
  int poses = 0;
  int colliding = 0;
  int on_edges_alone = 0;
  for (const PointShell& shell : edgy_shells()) {
    ASSERT_NE(shell.edges(), nullptr);
    for (const Field& field : fields()) {
      for (int i = 0; i < 36; ++i) {
        const double clearance = i % 3 == 0   ? random.uniform(0.01, 0.3)
                                 : i % 3 == 1 ? random.uniform(-0.01, 0.01)
                                              : random.uniform(-0.2, -0.01);
        const Pose pose = make_pose_at(field, shell, clearance, random);
        for (const float margin : {0.0f, 0.02f, -0.01f}) {
          expect_equal_to_flat(field, shell, pose, margin, scratch);
          if (testing::Test::HasFatalFailure()) return;
          const auto flat = find_contacts_flat(field, shell, pose, {.margin = margin});
          const ContactOptions few{.margin = margin, .max_points = 1 + random.below(20)};
          const auto fewest = find_contacts_flat(field, shell, pose, few);
          const auto found = find_contacts(field, shell, pose, few, other);
          ASSERT_TRUE(std::equal(found.begin(), found.end(), fewest.begin(), fewest.end()));
          const auto all = find_contacts_within_budget(field, shell, pose, {.margin = margin},
                                                       std::size_t{1} << 30, other);
          ASSERT_TRUE(all.is_exact);
          ASSERT_TRUE(
              std::equal(all.contacts.begin(), all.contacts.end(), flat.begin(), flat.end()));
          const auto some = find_contacts_within_budget(field, shell, pose, {.margin = margin},
                                                        random.below(300), other);
          std::map<std::uint32_t, Contact> left;
          for (const Contact& c : flat) left.emplace(c.id, c);
          for (const Contact& c : some.contacts) {
            ASSERT_TRUE(left.contains(c.id));
            ASSERT_EQ(left.at(c.id), c);
            left.erase(c.id);
          }
          if (some.is_exact) {
            ASSERT_TRUE(left.empty());
          }
          for (const auto& [id, c] : left) ASSERT_LE(c.depth, some.depth_bound);
        }
        const auto flat = find_contacts_flat(field, shell, pose, {.margin = 1e9f});
        const auto nearest = find_nearest(field, shell, pose, 1e9f, other);
        const auto deepest =
            std::max_element(flat.begin(), flat.end(),
                             [](const Contact& a, const Contact& b) { return a.depth < b.depth; });
        ASSERT_TRUE(nearest);
        ASSERT_NE(deepest, flat.end());
        ASSERT_EQ(*nearest, *deepest);
        const auto contacts = find_contacts(field, shell, pose, {}, scratch);
        ++poses;
        colliding += contacts.empty() ? 0 : 1;
        const std::size_t on_edges = count_on_edges(contacts, shell);
        on_edges_alone += on_edges > 0 && on_edges == contacts.size() ? 1 : 0;
      }
    }
  }
  EXPECT_GE(poses, 1'400);
  EXPECT_GT(colliding, 0.4 * poses);
  EXPECT_LT(colliding, 0.8 * poses);
  EXPECT_GT(on_edges_alone, 0);
}

TEST(ContactsOnEdges, OnTheVeryEdgeOfTheMarginAgreeAsWell) {
  Random random(181);
  QueryScratch scratch;
  const float infinity = std::numeric_limits<float>::infinity();
  for (const PointShell& shell : edgy_shells()) {
    for (const Field& field : fields()) {
      for (int i = 0; i < 6; ++i) {
        const Pose pose = make_pose_at(field, shell, random.uniform(-0.1, 0.1), random);
        const auto all = find_contacts_flat(field, shell, pose, {.margin = infinity});
        ASSERT_EQ(all.size(), shell.element_count());
        for (int trial = 0; trial < 4; ++trial) {
          const std::size_t at = shell.size() + random.below(shell.element_count() - shell.size());
          const float edge = -all[at].depth;
          for (const float margin : {edge, std::nextafter(edge, 1000.0f)}) {
            expect_equal_to_flat(field, shell, pose, margin, scratch);
            if (testing::Test::HasFatalFailure()) return;
          }
        }
      }
    }
  }
}

TEST(ContactsOnEdges, AgreeAtSimilarPosesOneAfterAnother) {
  Random random(182);
  QueryScratch own;
  QueryScratch scratch;
  QueryLists lists;
  scratch.borrow(lists);
  for (const PointShell& shell : edgy_shells()) {
    for (const Field& field : fields()) {
      Pose pose = make_pose_at(field, shell, 0.004, random);
      const Vec3 step = -0.002 * normalized(pose.translation);
      std::size_t found = 0;
      for (int i = 0; i < 30; ++i) {
        const auto contacts = find_contacts(field, shell, pose, {}, scratch);
        const auto flat = find_contacts_flat(field, shell, pose);
        ASSERT_TRUE(std::equal(contacts.begin(), contacts.end(), flat.begin(), flat.end()));
        const auto others = find_contacts(field, shell, pose, {}, own);
        ASSERT_TRUE(std::equal(others.begin(), others.end(), flat.begin(), flat.end()));
        found += flat.size();
        pose.translation += (i % 5 == 0 ? 1.0 : 0.05) * step;
      }
      EXPECT_GT(found, 0u);
    }
  }
}

TEST(ContactsOnEdges, OfCrossedBarsAreFoundWithinATolerance) {
  constexpr double kTolerance = 2e-4;
  const Vec3 half{0.5, 0.005, 0.005};
  const PointShell shell = make_exact_shell(make_box(half), kTolerance);
  const Field analytic = BoxField{half};
  const Field grid = make_grid(make_box(half), 5e-4);
  QueryScratch scratch;
  Random random(183);
  for (const bool on_edge : {false, true}) {
    const double reach = on_edge ? std::sqrt(2.0) * half.y : half.y;
    const Matrix3 own = turn_about_x(on_edge ? kEighthTurn : 0.0);
    int found = 0;
    for (int i = 0; i < 200; ++i) {
      const double overlap = random.uniform(kTolerance, 6e-4);
      const double apart = i % 2 == 0 ? -overlap : random.uniform(1e-6, 1e-3);
      const Matrix3 crossing = turn_about_z(random.uniform(0.4, 2.7));
      // Both bars stand on their edges or lie on their faces, b across a.
      const Pose world_from_a{own, {random.uniform(-0.3, 0.3), 0, 0}};
      const Pose world_from_b{crossing * own, crossing * Vec3{random.uniform(-0.3, 0.3), 0, 0} +
                                                  Vec3{0, 0, 2 * reach + apart}};
      const Pose a_from_b = world_from_a.inverse() * world_from_b;
      for (const Pose& pose : {a_from_b, a_from_b.inverse()}) {
        const auto contacts = find_contacts(analytic, shell, pose, {}, scratch);
        ASSERT_EQ(contacts.empty(), apart > 0.0) << on_edge << " " << apart;
        ASSERT_EQ(collides(analytic, shell, pose), apart < 0.0);
        float deepest = 0.0f;
        for (const Contact& c : contacts) deepest = std::max(deepest, c.depth);
        if (apart < 0.0) {
          ASSERT_NEAR(static_cast<double>(deepest), overlap, kTolerance) << on_edge;
          ++found;
        }
        const auto nearest = find_nearest(grid, shell, pose, 0.1f, scratch);
        ASSERT_TRUE(nearest);
        // A trilinear field rounds the edge off.
        ASSERT_NEAR(static_cast<double>(nearest->depth), -apart, 2 * kTolerance) << on_edge;
      }
    }
    EXPECT_EQ(found, 200);
  }
}

TEST(ContactsOnEdges, ThatLieFlatDoNotJump) {
  const Vec3 half{0.1, 0.02, 0.03};
  const PointShell shell = make_exact_shell(make_box(half), 2e-4);
  const std::vector<Field> grounds{PlaneField{{0, 0, 1}, 0.0}, BoxField{{1, 1, 1}},
                                   make_grid(make_box({0.2, 0.2, 0.05}), 0.004)};
  const double tops[] = {0.0, 1.0, 0.05};
  for (std::size_t ground = 0; ground < grounds.size(); ++ground) {
    const double stands = std::sqrt(0.5) * (half.y + half.z);
    const auto ask = [&](double tilt) {
      const Pose pose{turn_about_y(tilt) * turn_about_x(kEighthTurn),
                      {0.003, 0.002, tops[ground] + stands - 1e-4}};
      QueryScratch scratch;
      const auto contacts = find_contacts(grounds[ground], shell, pose, {}, scratch);
      return std::vector<Contact>(contacts.begin(), contacts.end());
    };
    const auto flat = ask(0.0);
    std::size_t on_edge = 0;
    for (const double tilt : {-1e-7, 1e-7}) {
      const auto tilted = ask(tilt);
      ASSERT_EQ(flat.size(), tilted.size());
      for (std::size_t i = 0; i < flat.size(); ++i) {
        ASSERT_EQ(flat[i].id, tilted[i].id);
        ASSERT_LT(length(flat[i].point - tilted[i].point), 1e-4f);
        on_edge += shell.is_point(flat[i].id) ? 0u : 1u;
      }
    }
    // One place a piece of the edge, its middle.
    EXPECT_GE(on_edge, 2 * 70u);
    for (const Contact& c : flat) {
      if (shell.is_point(c.id)) continue;
      const auto piece = static_cast<std::size_t>(c.id) - shell.size();
      if (std::abs(shell.edges()->halves()[piece].x) < 1e-4f) continue;  // the ends' cross edges
      ASSERT_LT(length(c.point - shell.edges()->middles()[piece]), 1e-5f);
    }
  }
}

TEST(ContactsOnEdges, MoveLittleWhileTheBodyTurnsLittle) {
  const PointShell shell = make_exact_shell(make_box({0.1, 0.02, 0.03}), 2e-4);
  const Field ground = PlaneField{{0, 0, 1}, 0.0};
  QueryScratch scratch;
  const double stands = std::sqrt(0.5) * 0.05;
  std::map<std::uint32_t, Vec3f> last;
  std::size_t followed = 0;
  for (int i = -4000; i <= 4000; ++i) {
    const double tilt = 1e-5 * i;
    const Pose pose{turn_about_y(tilt) * turn_about_x(kEighthTurn), {0, 0, stands - 4e-3}};
    std::map<std::uint32_t, Vec3f> now;
    for (const Contact& c : find_contacts(ground, shell, pose, {}, scratch)) {
      if (!shell.is_point(c.id)) now[c.id] = c.point;
    }
    for (const auto& [id, point] : now) {
      if (!last.contains(id)) continue;
      ASSERT_LT(length(point - last[id]), 1e-4f) << tilt;
      ++followed;
    }
    last = now;
  }
  EXPECT_GT(followed, 100'000u);
}

TEST(ContactsOnEdges, HaveElementsAfterThePointsAndSegmentsOfTheirOwn) {
  const PointShell& shell = edgy_shells()[0];
  const auto points = static_cast<std::uint32_t>(shell.size());
  const auto count = static_cast<std::uint32_t>(shell.element_count());
  for (const int level : {1, 3, 12}) {
    std::uint32_t last = 0;
    for (std::uint32_t id = 0; id < count; ++id) {
      const std::uint32_t segment = shell.segment_of(id, level);
      ASSERT_GE(segment, last);
      ASSERT_EQ(segment >= PointSphereTree::cluster_count(level), id >= points);
      const PointRange range = shell.segment_elements(level, segment);
      ASSERT_TRUE(range.begin <= id && id < range.end);
      last = segment;
    }
  }
  EXPECT_EQ(shell.area_of(points), 0.0f);
  EXPECT_EQ(shell.normal_of(points), shell.edges()->normals()[0]);
}

TEST(ContactsOnEdges, AddNothingToAWrench) {
  const Vec3 half{0.1, 0.1, 0.1};
  const PointShell shell = make_exact_shell(make_box(half), 2e-4);
  QueryScratch scratch;
  const Pose pose{{}, {0, 0, 0.099}};
  const Wrench wrench = compute_wrench(PlaneField{{0, 0, 1}, 0.0}, shell, pose, 1e6, scratch);
  // A face of 0.04 m2 and what the sides have below the ground, 1 mm deep.
  EXPECT_NEAR(wrench.force.z, 1e6 * 0.04 * 1e-3, 5.0);
  EXPECT_GT(count_on_edges(scratch.contacts(), shell), 100u);
}

}  // namespace
}  // namespace voxshell::contacts_on_edges_test
