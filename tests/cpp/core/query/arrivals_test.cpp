#include <cstddef>
#include <cstdlib>
#include <vector>

#include <gtest/gtest.h>

#include "support/flat_loop.h"
#include "support/pairs.h"
#include "support/random.h"
#include "voxshell/contacts_flat.h"
#include "voxshell/manifold.h"

namespace voxshell::arrivals_test {
namespace {

using namespace test_support;

/// So many points that searches do not list them, and many edges.
const std::vector<PointShell>& large_shells() {
  static const auto* all = [] {
    auto* shells = new std::vector<PointShell>{make_shell(make_torus(0.4, 0.12, 40, 20), 0.008)};
    auto exact = PointShell::build(make_blob(0.35, 3).mesh(), {.tolerance = 1e-3});
    if (!exact) std::abort();
    shells->push_back(*std::move(exact));
    return shells;
  }();
  return *all;
}

TEST(Arrivals, AreAskedAboutAsByTheFlatLoopToTheBit) {
  Random random(77);
  std::size_t all = 0;
  std::size_t arriving_of_them = 0;
  for (const PointShell& shell : large_shells()) {
    for (const Field& field : fields()) {
      for (int i = 0; i < 6; ++i) {
        const Pose pose = make_pose_at(field, shell, random.uniform(-0.02, 0.1), random);
        const auto margin = static_cast<float>(random.uniform(0.1, 0.4));
        std::vector<Arrival> arrivals;
        for (std::size_t k = 0; k <= random.below(kMostArrivals); ++k) {
          Pose moved = pose;
          moved.translation += random.uniform(0.0, 0.2) * random.direction();
          arrivals.push_back({moved, static_cast<float>(random.uniform(0.0, 0.1))});
        }
        const auto flat = find_contacts_flat(field, shell, pose, {.margin = margin});
        all += flat.size();
        arriving_of_them +=
            expect_arriving_equal_to_flat(field, shell, pose, margin, flat, arrivals);
      }
    }
  }
  EXPECT_GT(arriving_of_them, all / 20);
  EXPECT_LT(arriving_of_them, all / 2);
}

}  // namespace
}  // namespace voxshell::arrivals_test
