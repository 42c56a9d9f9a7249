#include "voxshell/contacts.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <limits>
#include <string>
#include <tuple>
#include <utility>
#include <variant>
#include <vector>

#include <gtest/gtest.h>

#include "field/brick_entry.h"
#include "support/brute_force.h"
#include "support/flat_loop.h"
#include "support/meshes.h"
#include "support/pairs.h"
#include "support/random.h"
#include "voxshell/contacts_flat.h"

namespace voxshell::contacts_test {
namespace {

using namespace test_support;

/// What contacts promise whatever found them.
void expect_sound(const std::vector<Contact>& contacts, const PointShell& shell, float margin) {
  std::int64_t last = -1;
  for (const Contact& contact : contacts) {
    ASSERT_GT(contact.id, last);
    last = contact.id;
    ASSERT_LT(contact.id, shell.size());
    ASSERT_EQ(contact.point, shell.points()[contact.id]);
    ASSERT_GT(contact.depth, -margin);
    ASSERT_NEAR(length(contact.normal), 1.0f, 1e-5f);
  }
}

TEST(Contacts, AmongLargeCellsAreThoseOfTheFlatLoop) {
  const TriangleMesh blob = make_blob(0.35, 3).mesh();
  const auto built = GridField::build(blob, {.voxel_size = 0.01, .padding = 0.4});
  ASSERT_TRUE(built);
  const Field field = *built;
  std::vector<float> margins;
  for (const double floor : built->data().coarse_floors) {
    ASSERT_LT(floor, 0.2) << "there are no large cells";
    const auto margin = static_cast<float>(floor);
    margins.insert(margins.end(), {-margin, 0.9f * margin, margin, 1.1f * margin});
  }
  const PointShell shell = make_shell(make_torus(0.1, 0.04, 40, 20), 0.006);
  Random random(104);
  QueryScratch scratch;
  int listed = 0;
  for (int i = 0; i < 300; ++i) {
    const Pose pose{random.rotation(), random.uniform(0.0, 0.8) * random.direction()};
    const auto all =
        find_contacts_flat(field, shell, pose, {.margin = std::numeric_limits<float>::max()});
    // Around where larger cells begin, and as far as the nearest, the farthest and one between.
    for (const float margin : margins) expect_equal_to_flat(field, shell, pose, margin, scratch);
    for (const std::size_t at : {std::size_t{0}, all.size() / 2, all.size() - 1}) {
      const float own = -all[at].depth;
      for (const float margin : {own, std::nextafter(own, 1000.0f)}) {
        expect_equal_to_flat(field, shell, pose, margin, scratch);
      }
      if (std::abs(own) > margins[2]) ++listed;
    }
  }
  EXPECT_GT(listed, 200);
}

/// Distances that fall to all sides of a peak on which they are `top` voxels: a brick of cells of
/// one voxel, beside it one with `cells` along each axis. The peak is in the middle of the side of
/// one of these, of which they know the corners alone.
GridField make_peak(double voxel_size, int top, int cells) {
  constexpr int kEdge = simd::kBrickCells;
  GridFieldData data;
  data.voxel_size = voxel_size;
  data.bricks = {2, 1, 1};
  data.surface_bounds = {{0.0, 0.0, 0.0},
                         {2 * kEdge * voxel_size, kEdge * voxel_size, kEdge * voxel_size}};
  data.node_error = voxel_size / (2 * data.quanta_per_voxel);
  data.coarse_floors.fill(static_cast<double>(simd::kNoCoarseFloor));
  for (int i = 0; cells < kEdge >> i; ++i) {
    data.coarse_floors[static_cast<std::size_t>(i)] = 3.0 * voxel_size;
  }
  const double middle = 0.5 * kEdge / cells;
  const auto put = [&](int first_x, int last_x, int step) {
    for (int z = 0; z <= kEdge; z += step) {
      for (int y = 0; y <= kEdge; y += step) {
        for (int x = first_x; x <= last_x; x += step) {
          const double distance = top - length(Vec3{x - 1.0 * kEdge, y - middle, z - middle});
          data.samples.push_back(
              static_cast<std::int16_t>(std::lrint(distance * data.quanta_per_voxel)));
        }
      }
    }
    while (data.samples.size() % simd::kSampleAlignment != 0) data.samples.push_back(0);
  };
  put(0, 2 * kEdge, kEdge);  // the corners of both
  const std::size_t fine = data.samples.size();
  put(0, kEdge, 1);
  const std::size_t coarse = cells == 1 ? 1 : data.samples.size();
  if (cells > 1) put(kEdge, 2 * kEdge, kEdge / cells);
  data.entries = {BrickEntry{.cells = kEdge, .first = fine}.pack(),
                  BrickEntry{.cells = cells, .first = coarse}.pack()};
  data.samples.resize(std::max<std::size_t>(data.samples.size(), simd::kFewestSamples));
  return GridField(std::move(data));
}

TEST(Contacts, AreNotMissedInLargeCellsThatAreMetFromSmallOnes) {
  constexpr double kVoxel = 0.01;
  Random random(105);
  QueryScratch scratch;
  for (const int top : {16, -8}) {
    for (const int cells : {1, 2, 4}) {
      const Field field = make_peak(kVoxel, top, cells);
      const double half_cell = 4.0 / cells;  // voxels
      const double radius = 0.25 * half_cell * kVoxel;
      const PointShell shell = make_shell(make_icosphere(radius, 2), 0.5 * radius);
      const Vec3 peak{8 * kVoxel, half_cell * kVoxel, half_cell * kVoxel};
      // Points in the small cells are above.
      const double lower = 0.75 * std::sqrt(2.0) * half_cell;
      const auto margin = static_cast<float>((top - lower) * kVoxel);
      int met = 0;
      for (int i = 0; i < 100; ++i) {
        const Pose pose{random.rotation(), peak + random.uniform(0.0, radius) * random.direction()};
        expect_equal_to_flat(field, shell, pose, margin, scratch);
        const std::size_t found = scratch.contacts().size();
        if (found > 0 && found < shell.size()) ++met;
      }
      EXPECT_GT(met, 80) << top << ", cells of " << 2.0 * half_cell;
      // A point that creeps over the border, where what the last query was left with serves again.
      for (std::uint32_t id = 0; id < shell.size(); id += 7) {
        Pose pose{random.rotation(), {}};
        pose.translation = peak - pose.rotation * static_cast<Vec3>(shell.points()[id]);
        for (const double x : {-2e-6, -1e-6, 1e-6}) {
          Pose moved = pose;
          moved.translation.x += x;
          expect_equal_to_flat(field, shell, moved, margin, scratch);
        }
        EXPECT_GT(scratch.contacts().size(), 0u);
      }
    }
  }
}

/// Of a pair: VOXSHELL_POSES in the environment, or few.
int number_of_poses() {
  const char* wanted = std::getenv("VOXSHELL_POSES");
  return wanted == nullptr ? 120 : std::atoi(wanted);
}

/// A shell and a field of pairs.h.
class ContactsOfPair : public testing::TestWithParam<std::tuple<std::size_t, std::size_t>> {};

TEST_P(ContactsOfPair, AreThoseOfTheFlatLoopToTheBit) {
  const auto [shell_number, field_number] = GetParam();
  const PointShell& shell = shells()[shell_number];
  const Field& field = fields()[field_number];
  Random random(100 + 10 * field_number + shell_number);
  QueryScratch scratch;
  int colliding = 0;
  int near = 0;
  const int poses = number_of_poses();
  ASSERT_GE(poses, 120);
  for (int i = 0; i < poses; ++i) {
    // A third far away, a third about to touch, a third inside.
    const double clearance = i % 3 == 0   ? random.uniform(0.01, 0.5)
                             : i % 3 == 1 ? random.uniform(-0.01, 0.01)
                                          : random.uniform(-0.2, -0.01);
    const Pose pose = make_pose_at(field, shell, clearance, random);
    for (const float margin : {0.0f, 0.02f, -0.01f, -0.1f}) {
      expect_equal_to_flat(field, shell, pose, margin, scratch);
      if (HasFatalFailure()) return;
      expect_sound(find_contacts_flat(field, shell, pose, {.margin = margin}), shell, margin);
      if (HasFatalFailure()) return;
    }
    const double smallest = smallest_distance(field, shell, pose);
    colliding += smallest < 0.0;
    near += std::abs(smallest) < 0.02;
  }
  EXPECT_GT(colliding, 0.3 * poses);
  EXPECT_GT(near, 0.3 * poses);
  EXPECT_LT(colliding, 0.7 * poses);
}

std::string name_of_pair(const testing::TestParamInfo<ContactsOfPair::ParamType>& pair) {
  static constexpr std::array kShells{"Torus", "L", "Blob", "Wedge"};
  static constexpr std::array kFields{"TorusGrid", "LGrid",   "BlobGrid", "Plane", "Box",
                                      "Sphere",    "Capsule", "Cylinder", "Cone",  "Convex"};
  return std::string(kShells.at(std::get<0>(pair.param))) + "In" +
         kFields.at(std::get<1>(pair.param));
}

INSTANTIATE_TEST_SUITE_P(Pairs, ContactsOfPair,
                         testing::Combine(testing::Range<std::size_t>(0, 4),
                                          testing::Range<std::size_t>(0, 10)),
                         name_of_pair);

TEST(Contacts, OnTheVeryEdgeOfTheMarginAgreeAsWell) {
  // The margin is a point's own distance or the next number: rounding in a bound that is meant to
  // be below all distances shows here first.
  Random random(101);
  QueryScratch scratch;
  for (const PointShell& shell : shells()) {
    for (const Field& field : fields()) {
      for (int i = 0; i < 30; ++i) {
        const Pose pose = make_pose_at(field, shell, random.uniform(-0.1, 0.1), random);
        const auto all =
            find_contacts_flat(field, shell, pose, {.margin = std::numeric_limits<float>::max()});
        ASSERT_EQ(all.size(), shell.size());
        const auto nearest =
            std::max_element(all.begin(), all.end(),
                             [](const Contact& a, const Contact& b) { return a.depth < b.depth; });
        for (const Contact& at : {*nearest, all[random.below(all.size())]}) {
          const float edge = -at.depth;
          const float beyond = std::nextafter(edge, 1000.0f);
          expect_equal_to_flat(field, shell, pose, edge, scratch);
          expect_equal_to_flat(field, shell, pose, beyond, scratch);
          if (testing::Test::HasFatalFailure()) return;
        }
        const float edge = -nearest->depth;
        EXPECT_FALSE(collides(field, shell, pose, edge));
        EXPECT_TRUE(collides(field, shell, pose, std::nextafter(edge, 1000.0f)));
      }
    }
  }
}

TEST(Contacts, AgreeAtSimilarPosesOneAfterAnother) {
  // A slide through contact, as in a simulation, with one scratch for everything.
  Random random(102);
  QueryScratch scratch;
  for (const PointShell& shell : shells()) {
    for (const Field& field : fields()) {
      Pose pose = make_pose_at(field, shell, 0.02, random);
      const Vec3 step = -0.002 * normalized(pose.translation);
      std::size_t found = 0;
      for (int i = 0; i < 60; ++i) {
        expect_equal_to_flat(field, shell, pose, 0.0f, scratch);
        if (testing::Test::HasFatalFailure()) return;
        found += scratch.contacts().size();
        pose.translation += step;
      }
      EXPECT_GT(found, 0u);
    }
  }
}

TEST(Contacts, OfBodiesFarFromTheWorldsOriginAreThoseNearIt) {
  Random random(103);
  QueryScratch scratch;
  int colliding = 0;
  for (const double far : {1e3, 1e5}) {
    for (const PointShell& shell : shells()) {
      for (const Field& field : fields()) {
        for (int i = 0; i < 10; ++i) {
          const Pose field_from_shell = make_pose_at(field, shell, random.uniform(-0.1, 0), random);
          const Pose world_from_field{random.rotation(), far * random.direction()};
          const Pose world_from_shell = world_from_field * field_from_shell;
          const Pose far_pose = world_from_field.inverse() * world_from_shell;
          expect_equal_to_flat(field, shell, far_pose, 0.0f, scratch);
          if (testing::Test::HasFatalFailure()) return;
          // World coordinates in float64 keep 1e-10 of 1e5 m.
          const auto near_contacts = find_contacts_flat(field, shell, field_from_shell, {1e-6f});
          for (const Contact& contact : scratch.contacts()) {
            const auto same = std::find_if(near_contacts.begin(), near_contacts.end(),
                                           [&](const Contact& c) { return c.id == contact.id; });
            ASSERT_NE(same, near_contacts.end());
            ASSERT_NEAR(same->depth, contact.depth, 1e-6f);
          }
          colliding += !scratch.contacts().empty();
        }
      }
    }
  }
  EXPECT_GT(colliding, 300);
}

TEST(Contacts, OfAShellFarFromItsFieldsOriginAgree) {
  // The rounding of large coordinates is in the bounds: here float32 itself is off by 8 mm.
  Random random(104);
  QueryScratch scratch;
  for (const double far : {1e3, 1e5}) {
    for (const PointShell& shell : shells()) {
      for (const Vec3& direction : {Vec3{0, 0, 1}, Vec3{0.6, 0, 0.8}}) {
        const std::vector<Field> fields_there{SphereField{far}, BoxField{{far, far, far}},
                                              PlaneField{direction, far}};
        for (const Field& field : fields_there) {
          std::size_t found = 0;
          for (int i = 0; i < 30; ++i) {
            const double clearance = random.uniform(-0.5, 0.5);
            Vec3 place = (far + clearance) * direction;
            if (std::holds_alternative<BoxField>(field)) place = {0.1 * far, 0, far + clearance};
            expect_equal_to_flat(field, shell, {random.rotation(), place}, 0.0f, scratch);
            if (testing::Test::HasFatalFailure()) return;
            found += scratch.contacts().size();
          }
          EXPECT_GT(found, 1000u);
        }
      }
    }
  }
}

TEST(Contacts, WithRotationsAtTheEdgeOfWhatPosesMayBeAgree) {
  // Pose::from_matrix takes rotations that are off orthonormal by a millionth.
  Random random(105);
  QueryScratch scratch;
  for (const PointShell& shell : shells()) {
    for (const Field& field : fields()) {
      for (int i = 0; i < 40; ++i) {
        Pose pose = make_pose_at(field, shell, random.uniform(-0.05, 0.01), random);
        for (Vec3* row : {&pose.rotation.row_x, &pose.rotation.row_y, &pose.rotation.row_z}) {
          *row = (1.0 + random.uniform(-4.9e-7, 4.9e-7)) * *row;
        }
        const auto all =
            find_contacts_flat(field, shell, pose, {.margin = std::numeric_limits<float>::max()});
        float nearest = std::numeric_limits<float>::infinity();
        for (const Contact& c : all) nearest = std::min(nearest, -c.depth);
        for (const float margin : {0.0f, nearest, std::nextafter(nearest, 1000.0f)}) {
          expect_equal_to_flat(field, shell, pose, margin, scratch);
          if (testing::Test::HasFatalFailure()) return;
        }
      }
    }
  }
}

TEST(Contacts, OfABodyWhollyInsideAnotherAreAllItsPoints) {
  const Field box = make_grid(make_box({1, 1, 1}), 0.0625);
  const PointShell blob = make_shell(make_blob(0.3, 3), 0.05);
  QueryScratch scratch;
  Random random(106);
  for (int i = 0; i < 20; ++i) {
    const Pose pose{random.rotation(), random.in_cube(0.4)};
    EXPECT_EQ(find_contacts(box, blob, pose, {}, scratch).size(), blob.size());
    expect_equal_to_flat(box, blob, pose, 0.0f, scratch);
    EXPECT_TRUE(collides(box, blob, pose));
    EXPECT_TRUE(collides(BoxField{{1, 1, 1}}, blob, pose));
  }
}

TEST(Contacts, DeeperThanANegativeMarginAreFoundInTheMiddleOfABody) {
  // Regression: with a negative margin the tree skipped what lay within the field's bounds.
  const Field box = make_grid(make_box({1, 1, 1}), 0.125);
  const PointShell blob = make_shell(make_blob(0.3, 3), 0.05);
  QueryScratch scratch;
  const Pose pose{};
  EXPECT_EQ(find_contacts(box, blob, pose, {.margin = -0.5f}, scratch).size(), blob.size());
  expect_equal_to_flat(box, blob, pose, -0.65f, scratch);
  EXPECT_GT(scratch.contacts().size(), 0u);
  EXPECT_LT(scratch.contacts().size(), blob.size());
}

TEST(Contacts, WithMarginsOfEverySizeAgree) {
  Random random(107);
  QueryScratch scratch;
  const float infinity = std::numeric_limits<float>::infinity();
  for (const PointShell& shell : shells()) {
    for (const Field& field : fields()) {
      const Pose pose = make_pose_at(field, shell, -0.05, random);
      for (const float margin : {infinity, std::numeric_limits<float>::max(), 1e6f, 1.0f, 1e-30f,
                                 -1e-30f, -1.0f, -1e6f, -infinity}) {
        expect_equal_to_flat(field, shell, pose, margin, scratch);
        if (testing::Test::HasFatalFailure()) return;
        if (margin >= 1e6f) {
          EXPECT_EQ(scratch.contacts().size(), shell.size());
        }
        if (margin <= -1.0f) {
          EXPECT_TRUE(scratch.contacts().empty());
        }
      }
    }
  }
}

TEST(Contacts, OfShellsOfFewPointsAgree) {
  Random random(108);
  QueryScratch scratch;
  for (const double spacing : {10.0, 0.6, 0.3, 0.2}) {
    const PointShell shell = make_shell(make_corner_tetrahedron(0.5), spacing);
    EXPECT_LT(shell.size(), 60u);
    for (const Field& field : fields()) {
      for (int i = 0; i < 50; ++i) {
        const Pose pose = make_pose_at(field, shell, random.uniform(-0.1, 0.05), random);
        expect_equal_to_flat(field, shell, pose, 0.0f, scratch);
        if (testing::Test::HasFatalFailure()) return;
      }
    }
  }
}

TEST(Contacts, HaveTrueDepthsWithinTheInterpolationErrorAndMissNoneDeeper) {
  // Against the meshes themselves, by brute force: nothing in common with fields and shells.
  Random random(109);
  QueryScratch scratch;
  const std::vector<Soup> soups{make_torus(0.4, 0.12, 40, 20), make_l_shape(0.3),
                                make_blob(0.35, 3)};
  std::size_t compared = 0;
  std::size_t must_touch = 0;
  for (std::size_t f = 0; f < soups.size(); ++f) {
    const TriangleMesh mesh = soups[f].mesh();
    const double error = std::get<GridField>(fields()[f]).interpolation_error() + 1e-6;
    for (const PointShell& shell : shells()) {
      for (int i = 0; i < 6; ++i) {
        const Pose pose = make_pose_at(fields()[f], shell, random.uniform(-0.2, 0.0), random);
        const auto contacts = find_contacts(fields()[f], shell, pose, {}, scratch);
        for (std::uint32_t id = 0; id < shell.size(); id += 7) {
          const double truth = signed_distance_to_mesh(
              pose.transform_point(static_cast<Vec3>(shell.points()[id])), mesh);
          const auto found = std::find_if(contacts.begin(), contacts.end(),
                                          [&](const Contact& c) { return c.id == id; });
          if (found == contacts.end()) {
            ASSERT_GT(truth, -error) << "a missed contact, " << -truth << " m deep";
          } else {
            ASSERT_NEAR(static_cast<double>(found->depth), -truth, error);
            ++compared;
          }
          must_touch += truth < -error;
        }
      }
    }
  }
  EXPECT_GT(compared, 500u);
  EXPECT_GT(must_touch, 300u);
}

TEST(Contacts, WithALongGridOfFineVoxelsAgree) {
  Random random(111);
  QueryScratch scratch;
  const Field rod = make_grid(moved(make_box({0.499, 0.002, 0.001}), {0.6, 0.3, -0.2}), 1.25e-4);
  const PointShell shell = make_shell(make_blob(0.01, 3), 0.001);
  for (int i = 0; i < 300; ++i) {
    const Vec3 place{random.uniform(0.1, 1.1), 0.3 + random.uniform(-0.015, 0.015),
                     -0.2 + random.uniform(-0.015, 0.015)};
    const Pose pose{random.rotation(), place};
    const auto all =
        find_contacts_flat(rod, shell, pose, {.margin = std::numeric_limits<float>::max()});
    const float edge = -all[random.below(all.size())].depth;
    for (const float margin : {0.0f, edge, std::nextafter(edge, 1000.0f)}) {
      expect_equal_to_flat(rod, shell, pose, margin, scratch);
      if (testing::Test::HasFatalFailure()) return;
    }
  }
}

TEST(Contacts, NoMoreThanAskedForAreTheDeepest) {
  Random random(112);
  QueryScratch scratch;
  int ties = 0;
  for (const PointShell& shell : shells()) {
    for (const Field& field : fields()) {
      for (int i = 0; i < 8; ++i) {
        Pose pose = make_pose_at(field, shell, -0.1, random);
        if (i == 0) pose.rotation = {};  // flat faces: many points of one depth
        const auto all = find_contacts_flat(field, shell, pose);
        for (const std::size_t most : {std::size_t{0}, std::size_t{1}, std::size_t{7},
                                       all.size() / 2, all.size(), all.size() + 1}) {
          std::vector<Contact> deepest;
          for (const Contact& c : all) {
            const auto is_before = [&](const Contact& other) {
              return other.depth > c.depth || (other.depth == c.depth && other.id < c.id);
            };
            const auto before = std::count_if(all.begin(), all.end(), is_before);
            if (static_cast<std::size_t>(before) < most) deepest.push_back(c);
            ties += static_cast<std::size_t>(before) == most && !deepest.empty() &&
                    c.depth == deepest.back().depth;
          }
          const ContactOptions options{.max_points = most};
          const auto found = find_contacts(field, shell, pose, options, scratch);
          ASSERT_TRUE(std::equal(deepest.begin(), deepest.end(), found.begin(), found.end()));
          ASSERT_EQ(find_contacts_flat(field, shell, pose, options), deepest);
        }
      }
    }
  }
  EXPECT_GT(ties, 5);
}

TEST(Contacts, OnAPlaneAreThePointsBelowIt) {
  // Closed form: a box of 0.6 x 0.6 x 0.3 m sunk into the floor by 10 mm.
  const PointShell shell = make_shell(make_box({0.3, 0.3, 0.15}), 0.03);
  const Field floor = PlaneField{};
  QueryScratch scratch;
  const auto contacts = find_contacts(floor, shell, {{}, {5, 6, 0.14}}, {}, scratch);
  std::size_t below = 0;
  for (const Vec3f& p : shell.points()) below += p.z < -0.1401f;
  EXPECT_GT(below, 400u);
  EXPECT_EQ(contacts.size(), below);
  for (const Contact& c : contacts) {
    EXPECT_NEAR(c.depth, -0.14f - c.point.z, 1e-6f);
    EXPECT_EQ(c.normal, (Vec3f{0, 0, 1}));
  }
}

TEST(Contacts, HaveNormalsInTheShellsFrame) {
  const PointShell shell = make_shell(make_icosphere(0.1, 2), 0.05);
  // The shell's z is the field's -x.
  const Pose field_from_shell{{{0, 0, -1}, {0, 1, 0}, {1, 0, 0}}, {0.45, 0, 0}};
  const Field ball = SphereField{0.4};
  QueryScratch scratch;
  const auto contacts = find_contacts(ball, shell, field_from_shell, {}, scratch);
  ASSERT_FALSE(contacts.empty());
  for (const Contact& c : contacts) {
    const Vec3 outwards = normalized(field_from_shell.transform_point(static_cast<Vec3>(c.point)));
    const Vec3 expected = field_from_shell.inverse().rotate(outwards);
    EXPECT_LE(length(static_cast<Vec3>(c.normal) - expected), 1e-6);
    EXPECT_LT(c.normal.z, -0.5f);
  }
}

TEST(Contacts, WithoutAGradientTakeTheReversedNormalOfTheShell) {
  // The cell in the middle of the box has eight equal corners.
  const GridField grid = make_grid(make_box({0.375, 0.375, 0.375}), 0.25);
  ASSERT_EQ(grid.gradient({0, 0, 0}), Vec3f{});
  const PointShell shell = make_shell(make_icosphere(0.001, 1), 10.0);
  const Pose pose{{}, -static_cast<Vec3>(shell.points()[0])};
  QueryScratch scratch;
  const auto contacts = find_contacts(grid, shell, pose, {}, scratch);
  ASSERT_EQ(contacts.size(), shell.size());
  for (const Contact& contact : contacts) {
    EXPECT_EQ(contact.depth, 0.25f);
    EXPECT_EQ(contact.normal, -shell.normals()[contact.id]);
  }
}

TEST(Contacts, OfPosesThatAreNotNumbersAreNoneAndCrashNothing) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  QueryScratch scratch;
  for (const Field& field : fields()) {
    Pose pose;
    pose.translation.y = nan;
    EXPECT_TRUE(find_contacts(field, shells()[0], pose, {}, scratch).empty());
    EXPECT_FALSE(collides(field, shells()[0], pose));
    pose = {{{nan, 0, 0}, {0, nan, 0}, {0, 0, nan}}, {}};
    EXPECT_TRUE(find_contacts(field, shells()[0], pose, {}, scratch).empty());
  }
}

TEST(Contacts, AreFoundFarOutsideOfAGridWithALargeMargin) {
  QueryScratch scratch;
  const PointShell& shell = shells()[2];
  for (const Field& field : fields()) {
    for (const double far : {10.0, 1e3, 1e6}) {
      const Pose pose{{}, far * normalized(Vec3{1, -2, 3})};
      expect_equal_to_flat(field, shell, pose, static_cast<float>(far), scratch);
      expect_equal_to_flat(field, shell, pose, static_cast<float>(far + 1), scratch);
      EXPECT_GT(scratch.contacts().size(), 0u);
    }
  }
}

}  // namespace
}  // namespace voxshell::contacts_test
