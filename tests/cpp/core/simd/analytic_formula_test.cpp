#include "simd/analytic_formula.h"

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <variant>
#include <vector>

#include <gtest/gtest.h>

#include "support/meshes.h"
#include "support/random.h"
#include "voxshell/field.h"

namespace voxshell::analytic_formula_test {
namespace {

using namespace simd::VOXSHELL_ISA;
using test_support::Random;

template <class F>
struct Values {
  F distance;
  Triple<F> gradient;
  F bound;
};

template <class View, class F>
Values<F> evaluate(const View& view, const Triple<F>& p, F radius) {
  return {evaluate_distance(view, p), evaluate_gradient(view, p),
          evaluate_lower_bound(view, p, radius)};
}

std::array<std::uint32_t, 5> to_bits(const Values<float>& v) {
  return {std::bit_cast<std::uint32_t>(v.distance), std::bit_cast<std::uint32_t>(v.gradient.x),
          std::bit_cast<std::uint32_t>(v.gradient.y), std::bit_cast<std::uint32_t>(v.gradient.z),
          std::bit_cast<std::uint32_t>(v.bound)};
}

Values<float> lane(const Values<F8>& v, int i) {
  return {v.distance[i], {v.gradient.x[i], v.gradient.y[i], v.gradient.z[i]}, v.bound[i]};
}

/// Random points, on a grid now and then: on axes, in planes of symmetry, on surfaces.
Vec3f make_point(Random& random) {
  const auto p = static_cast<Vec3f>(random.in_cube(1.5));
  if (random.below(3) > 0) return p;
  const auto snap = [](float v) { return static_cast<float>(static_cast<int>(4.0f * v)) / 4.0f; };
  return {snap(p.x), snap(p.y), snap(p.z)};
}

TEST(AnalyticFormula, GivesEightPointsTheBitsOfOne) {
  auto convex = ConvexField::create(test_support::make_icosphere(0.75, 1).mesh());
  ASSERT_TRUE(convex);
  const std::vector<Field> fields{PlaneField{Random(1).direction(), 0.25},
                                  SphereField{0.75},
                                  BoxField{{0.25, 0.5, 0.75}},
                                  CapsuleField{0.25, 0.5},
                                  CylinderField{0.5, 1.0},
                                  ConeField{0.75, 1.0},
                                  *std::move(convex)};
  Random random(2);
  for (const Field& field : fields) {
    std::visit(
        [&](const auto& typed) {
          if constexpr (!std::is_same_v<std::decay_t<decltype(typed)>, GridField>) {
            const auto view = typed.view();
            for (int round = 0; round < 2'000; ++round) {
              std::array<Vec3f, kLanes> points{};
              Triple<F8> p{};
              F8 radius{};
              for (int i = 0; i < kLanes; ++i) {
                const Vec3f point = make_point(random);
                points[static_cast<std::size_t>(i)] = point;
                set_lane(p, i, {point.x, point.y, point.z});
                set_lane(radius, i, static_cast<float>(random.unit()));
              }
              const auto eight = evaluate(view, p, radius);
              for (int i = 0; i < kLanes; ++i) {
                const Vec3f& point = points[static_cast<std::size_t>(i)];
                const auto one =
                    evaluate(view, Triple<float>{point.x, point.y, point.z}, radius[i]);
                ASSERT_EQ(to_bits(lane(eight, i)), to_bits(one))
                    << "field " << field.index() << " at " << point.x << ", " << point.y << ", "
                    << point.z;
                ASSERT_EQ(one.distance, typed.distance(point));
                ASSERT_EQ(one.gradient.x, typed.gradient(point).x);
                ASSERT_EQ(one.bound, typed.lower_bound(point, radius[i]));
              }
            }
          }
        },
        field);
  }
}

}  // namespace
}  // namespace voxshell::analytic_formula_test
