#include "voxshell/wrench.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <variant>
#include <vector>

#include <gtest/gtest.h>

#include "support/meshes.h"
#include "support/pairs.h"
#include "support/random.h"
#include "voxshell/contacts_flat.h"

namespace voxshell::wrench_test {
namespace {

using namespace test_support;

constexpr double kStiffness = 1e6;  // N/m3

double measure_area(const PointShell& shell) {
  double area = 0.0;
  for (const float a : shell.areas()) area += static_cast<double>(a);
  return area;
}

/// Half a voxel, or half the spacing of the shell.
double step_of(const Field& field, const PointShell& shell) {
  const auto* grid = std::get_if<GridField>(&field);
  return 0.5 * (grid != nullptr ? grid->voxel_size() : shell.spacing());
}

void expect_near(const Vec3& a, const Vec3& b, double tolerance) {
  EXPECT_NEAR(a.x, b.x, tolerance);
  EXPECT_NEAR(a.y, b.y, tolerance);
  EXPECT_NEAR(a.z, b.z, tolerance);
}

TEST(Wrench, OfABoxInTheFloorIsThatOfSpringsUnderItsPoints) {
  const PointShell box = make_shell(make_box({0.3, 0.3, 0.15}), 0.03);
  QueryScratch scratch;
  Vec3 force{};
  Vec3 torque{};
  for (std::size_t i = 0; i < box.size(); ++i) {
    const auto p = static_cast<Vec3>(box.points()[i]);
    if (p.z > -0.1499) continue;
    const Vec3 push{0, 0, kStiffness * static_cast<double>(box.areas()[i]) * 0.01};
    force += push;
    torque += cross(p, push);
  }
  // Of 0.36 m2, points on the rim stand for some of the sides.
  EXPECT_NEAR(force.z, kStiffness * 0.36 * 0.01, 0.1 * kStiffness * 0.36 * 0.01);
  const Wrench wrench = compute_wrench(PlaneField{}, box, {{}, {5, 6, 0.14}}, kStiffness, scratch);
  expect_near(wrench.force, force, 1e-4 * force.z);
  expect_near(wrench.torque, torque, 1e-4 * force.z);
  const Wrench twice =
      compute_wrench(PlaneField{}, box, {{}, {5, 6, 0.14}}, 2.0 * kStiffness, scratch);
  expect_near(twice.force, 2.0 * wrench.force, 1e-9 * force.z);
}

TEST(Wrench, IsTheSumOverTheContactsOfTheFlatLoop) {
  Random random(210);
  QueryScratch scratch;
  int colliding = 0;
  for (const PointShell& shell : shells()) {
    for (const Field& field : fields()) {
      const double h = step_of(field, shell);
      for (int i = 0; i < 12; ++i) {
        const Pose pose = make_pose_at(field, shell, random.uniform(-0.2, 0.01), random);
        const auto distance_at = [&](const Vec3& on_shell) {
          const auto p = static_cast<Vec3f>(pose.transform_point(on_shell));
          return std::visit(
              [&](const auto& typed) { return static_cast<double>(typed.distance(p)); }, field);
        };
        Vec3 force{};
        Vec3 torque{};
        double scale = 0.0;
        for (const Contact& c : find_contacts_flat(field, shell, pose)) {
          const auto p = static_cast<Vec3>(c.point);
          const auto slope = [&](const Vec3& along) {
            return (distance_at(p + h * along) - distance_at(p - h * along)) / (2.0 * h);
          };
          const Vec3 gradient{slope({1, 0, 0}), slope({0, 1, 0}), slope({0, 0, 1})};
          const double weight =
              kStiffness * static_cast<double>(shell.areas()[c.id]) * static_cast<double>(c.depth);
          force += weight * gradient;
          torque += cross(p, weight * gradient);
          scale += weight;
          ++colliding;
        }
        const Wrench wrench = compute_wrench(field, shell, pose, kStiffness, scratch);
        // Differences of float32 distances of a meter, over 15 mm, are off by some 1e-5.
        expect_near(wrench.force, force, 2e-4 * scale);
        expect_near(wrench.torque, torque, 2e-4 * scale);
      }
    }
  }
  EXPECT_GT(colliding, 20'000);
}

TEST(Wrench, IsZeroApart) {
  Random random(211);
  QueryScratch scratch;
  for (const PointShell& shell : shells()) {
    for (const Field& field : fields()) {
      const Pose pose = make_pose_at(field, shell, random.uniform(0.01, 1.0), random);
      const Wrench wrench = compute_wrench(field, shell, pose, kStiffness, scratch);
      EXPECT_EQ(wrench.force, Vec3{});
      EXPECT_EQ(wrench.torque, Vec3{});
    }
  }
}

/// The same sum with the contacts' normals, which jump where the nearest surface changes.
Vec3 sum_normals(const Field& field, const PointShell& shell, const Pose& pose) {
  Vec3 force{};
  for (const Contact& c : find_contacts_flat(field, shell, pose)) {
    force += kStiffness * static_cast<double>(shell.areas()[c.id]) * static_cast<double>(c.depth) *
             static_cast<Vec3>(c.normal);
  }
  return force;
}

TEST(Wrench, ChangesInProportionToTheMotion) {
  // A point contributes area * depth * gradient. Depths and gradients follow from the field's
  // Lipschitz constant, L: a step s changes a depth by L s, a central difference over h to either
  // side by sqrt(3) L s / h, and no gradient is longer than sqrt(3) L.
  QueryScratch scratch;
  const PointShell shell = make_shell(make_blob(0.15, 3), 0.02);
  const double area = measure_area(shell);
  struct Case {
    Field field;
    double lipschitz;
  };
  const std::vector<Case> cases{{BoxField{{0.3, 0.5, 0.2}}, 1.0},
                                {CylinderField{0.3, 0.6}, 1.0},
                                {make_grid(make_l_shape(0.3), 0.025), 1.8}};
  double largest_of_normals = 0.0;
  for (const auto& [field, lipschitz] : cases) {
    for (const double step : {1e-3, 1e-5}) {
      const double h = step_of(field, shell);
      double deepest = 0.0;
      double largest = 0.0;
      double largest_of_these_normals = 0.0;
      Vec3 last{};
      Vec3 last_of_normals{};
      const int steps = step == 1e-3 ? 600 : 1500;
      for (int i = 0; i <= steps; ++i) {
        // From outside through the middle, or a piece of that.
        const double along = (step == 1e-3 ? -0.45 : -0.06) + step * i;
        const Pose pose{{}, {0.07, 0.05, along}};
        const Wrench wrench = compute_wrench(field, shell, pose, kStiffness, scratch);
        for (const Contact& c : scratch.contacts()) {
          deepest = std::max(deepest, static_cast<double>(c.depth));
        }
        const Vec3 of_normals = sum_normals(field, shell, pose);
        if (i > 0) {
          largest = std::max(largest, length(wrench.force - last));
          largest_of_these_normals =
              std::max(largest_of_these_normals, length(of_normals - last_of_normals));
        }
        last = wrench.force;
        last_of_normals = of_normals;
      }
      const double slope = std::sqrt(3.0) * lipschitz;
      const double rounding = 1e-6 * (1.0 + deepest / h);
      const double bound =
          kStiffness * area * (slope * lipschitz * step + deepest * slope * step / h + rounding);
      EXPECT_GT(deepest, 0.05);
      EXPECT_GT(largest, 0.0);
      EXPECT_LE(largest, bound) << "step " << step;
      if (step == 1e-5) {
        largest_of_normals = std::max(largest_of_normals, largest_of_these_normals / bound);
      }
    }
  }
  // The bound tells continuous from not.
  EXPECT_GT(largest_of_normals, 2.0);
}

TEST(Wrench, LeavesTheContactsInTheScratch) {
  Random random(212);
  QueryScratch scratch;
  const Pose pose = make_pose_at(fields()[0], shells()[1], -0.05, random);
  compute_wrench(fields()[0], shells()[1], pose, kStiffness, scratch);
  const auto flat = find_contacts_flat(fields()[0], shells()[1], pose);
  ASSERT_FALSE(flat.empty());
  EXPECT_TRUE(
      std::equal(flat.begin(), flat.end(), scratch.contacts().begin(), scratch.contacts().end()));
}

}  // namespace
}  // namespace voxshell::wrench_test
