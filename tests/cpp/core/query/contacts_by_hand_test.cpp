#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <variant>
#include <vector>

#include <gtest/gtest.h>

#include "support/pairs.h"
#include "support/random.h"
#include "voxshell/contacts.h"
#include "voxshell/field.h"

namespace voxshell::contacts_by_hand_test {
namespace {

using namespace test_support;

/// To a 2^-30th of the least power of two above `size`, then to float32. No zero is negative.
float rounded(double number, double size) {
  const double quantum = std::pow(2.0, std::floor(std::log2(size)) + 1.0 - 30.0);
  return static_cast<float>(std::nearbyint(number / quantum) * quantum + 0.0);
}

double reach_of(const PointShell& shell) {
  const auto farthest = [](const PointSphereTree& tree) {
    const Sphere& root = tree.spheres(1)[0];
    return length(static_cast<Vec3>(root.center)) + static_cast<double>(root.radius);
  };
  const EdgeSegments* edges = shell.edges();
  const double of_edges =
      edges == nullptr ? 0.0 : farthest(edges->tree()) + static_cast<double>(edges->reach());
  return std::max(farthest(shell.tree()), of_edges);
}

/// The flat loop once more, from the fields' data alone, in plain float32 arithmetic. The library's
/// flat loop shares its evaluation with the tree; this one shares nothing, so a mistake in the
/// common part shows as well. Bit-equal, as the operations are the same in the same order.
struct ByHand {
  std::array<std::array<float, 3>, 3> rotation;
  std::array<float, 3> translation;

  ByHand(const Pose& pose, double reach) {
    const std::array rows{pose.rotation.row_x, pose.rotation.row_y, pose.rotation.row_z};
    for (std::size_t r = 0; r < 3; ++r) {
      rotation[r] = {rounded(rows[r].x, 1.0), rounded(rows[r].y, 1.0), rounded(rows[r].z, 1.0)};
    }
    translation = {rounded(pose.translation.x, reach), rounded(pose.translation.y, reach),
                   rounded(pose.translation.z, reach)};
  }

  std::array<float, 3> to_field(const Vec3f& p) const {
    std::array<float, 3> q{};
    for (std::size_t r = 0; r < 3; ++r) {
      const float rotated = rotation[r][0] * p.x + rotation[r][1] * p.y + rotation[r][2] * p.z;
      q[r] = rotated + translation[r];
    }
    return q;
  }

  Vec3f to_shell(const std::array<float, 3>& g) const {
    std::array<float, 3> v{};
    for (std::size_t c = 0; c < 3; ++c) {
      v[c] = rotation[0][c] * g[0] + rotation[1][c] * g[1] + rotation[2][c] * g[2];
    }
    return {v[0], v[1], v[2]};
  }
};

struct Value {
  float distance;
  std::array<float, 3> gradient;
};

float norm(const std::array<float, 3>& v) {
  return std::sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
}

Value evaluate_cell(const GridFieldData& data, std::uint32_t entry,
                    const std::array<float, 3>& within, float h, float per_meter) {
  const int cells = 1 << (entry & 3u);
  const float size = 8.0f / static_cast<float>(cells);
  std::array<int, 3> cell{};
  std::array<float, 3> t{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const float place = within[axis] / size;
    cell[axis] = static_cast<int>(place) == cells ? cells - 1 : static_cast<int>(place);
    t[axis] = place - static_cast<float>(cell[axis]);
  }
  // Bricks of one cell share their corners with others.
  const int row = (cells == 1 ? data.bricks[0] : cells) + 1;
  const int layer = row * ((cells == 1 ? data.bricks[1] : cells) + 1);
  const std::size_t first = (cells == 1 ? 1 : 4) * (entry >> 7);
  std::array<std::array<std::array<float, 2>, 2>, 2> corner{};  // [x][y][z]
  for (int i = 0; i < 2; ++i) {
    for (int j = 0; j < 2; ++j) {
      for (int k = 0; k < 2; ++k) {
        const auto index =
            static_cast<std::size_t>(cell[0] + i + row * (cell[1] + j) + layer * (cell[2] + k));
        corner[static_cast<std::size_t>(i)][static_cast<std::size_t>(j)]
              [static_cast<std::size_t>(k)] = static_cast<float>(data.samples[first + index]);
      }
    }
  }
  const float unit = h / 256.0f * static_cast<float>(1 << (entry >> 3 & 15u));
  const auto mix = [](float a, float b, float fraction) { return a + fraction * (b - a); };
  std::array<std::array<float, 2>, 2> along_x{};  // [y][z]
  for (std::size_t j = 0; j < 2; ++j) {
    for (std::size_t k = 0; k < 2; ++k) {
      along_x[j][k] = mix(corner[0][j][k], corner[1][j][k], t[0]);
    }
  }
  const float below = mix(along_x[0][0], along_x[1][0], t[1]);
  const float above = mix(along_x[0][1], along_x[1][1], t[1]);
  Value value{mix(below, above, t[2]) * unit, {}};

  const auto slope_x = [&](std::size_t j, std::size_t k) {
    return corner[1][j][k] - corner[0][j][k];
  };
  const auto slope_y = [&](std::size_t i, std::size_t k) {
    return corner[i][1][k] - corner[i][0][k];
  };
  const auto slope_z = [&](std::size_t i, std::size_t j) {
    return corner[i][j][1] - corner[i][j][0];
  };
  const float steepness = unit * per_meter / size;
  value.gradient = {
      mix(mix(slope_x(0, 0), slope_x(1, 0), t[1]), mix(slope_x(0, 1), slope_x(1, 1), t[1]), t[2]) *
          steepness,
      mix(mix(slope_y(0, 0), slope_y(1, 0), t[0]), mix(slope_y(0, 1), slope_y(1, 1), t[0]), t[2]) *
          steepness,
      mix(mix(slope_z(0, 0), slope_z(1, 0), t[0]), mix(slope_z(0, 1), slope_z(1, 1), t[0]), t[1]) *
          steepness};
  return value;
}

Value evaluate(const GridField& field, const std::array<float, 3>& q) {
  const GridFieldData& data = field.data();
  const auto h = static_cast<float>(data.voxel_size);
  const auto per_meter = static_cast<float>(1.0 / data.voxel_size);
  std::array<float, 3> within{};  // the brick, voxels
  std::array<float, 3> beyond{};
  std::array<int, 3> brick{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const int cells = 8 * data.bricks[axis];
    const auto origin = static_cast<float>(data.origin[static_cast<int>(axis)]);
    const float place = (q[axis] - origin) * per_meter;
    float in_grid = place;
    if (in_grid < 0.0f) in_grid = 0.0f;
    if (in_grid > static_cast<float>(cells)) in_grid = static_cast<float>(cells);
    beyond[axis] = (place - in_grid) * h;
    const int cell = static_cast<int>(in_grid) == cells ? cells - 1 : static_cast<int>(in_grid);
    brick[axis] = cell / 8;
    within[axis] = in_grid - static_cast<float>(8 * brick[axis]);
  }
  const std::uint32_t entry = data.entries[static_cast<std::size_t>(
      brick[0] + data.bricks[0] * (brick[1] + data.bricks[1] * brick[2]))];
  Value value{};
  if ((entry & 4u) != 0) {
    const float* plane = &data.planes[4 * (entry >> 7)];
    value.gradient = {plane[0], plane[1], plane[2]};
    value.distance = plane[0] * (q[0] - beyond[0]) + plane[1] * (q[1] - beyond[1]) +
                     plane[2] * (q[2] - beyond[2]) - plane[3];
  } else {
    value = evaluate_cell(data, entry, within, h, per_meter);
  }
  if (beyond == std::array<float, 3>{}) return value;
  const float steepness = norm(value.gradient);
  std::array<float, 3> away{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const float direction = steepness > 0.0f ? value.gradient[axis] / steepness : 0.0f;
    away[axis] = beyond[axis] + value.distance * direction;
  }
  const float far = norm(away);
  const float least = std::sqrt(beyond[0] * beyond[0] + beyond[1] * beyond[1] +
                                beyond[2] * beyond[2] + value.distance * value.distance);
  value.distance = std::max(far, least);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    value.gradient[axis] = far > 0.0f ? away[axis] / far : 0.0f;
  }
  return value;
}

Value evaluate(const SphereField& ball, const std::array<float, 3>& q) {
  const float far = norm(q);
  if (far == 0.0f) return {-static_cast<float>(ball.radius), {0, 0, 1}};
  return {far - static_cast<float>(ball.radius), {q[0] / far, q[1] / far, q[2] / far}};
}

Value evaluate(const BoxField& box, const std::array<float, 3>& q) {
  std::array<float, 3> beyond{};
  std::array<float, 3> outside{};
  std::size_t nearest = 0;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    beyond[axis] =
        std::fabs(q[axis]) - static_cast<float>(box.half_extents[static_cast<int>(axis)]);
    outside[axis] = beyond[axis] > 0.0f ? beyond[axis] : 0.0f;
    if (beyond[axis] > beyond[nearest]) nearest = axis;
  }
  const auto signed_like = [&](float v, std::size_t axis) {
    return std::signbit(q[axis]) ? -v : v;
  };
  Value value{};
  if (beyond[nearest] <= 0.0f) {
    value.distance = beyond[nearest];
    value.gradient[nearest] = signed_like(1.0f, nearest);
    return value;
  }
  value.distance = norm(outside);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    value.gradient[axis] = signed_like(outside[axis], axis) / value.distance;
  }
  return value;
}

/// The formulas of the other fields have tests of their own.
template <class F>
Value evaluate(const F& field, const std::array<float, 3>& q) {
  const Vec3f p{q[0], q[1], q[2]};
  const Vec3f g = field.gradient(p);
  return {field.distance(p), {g.x, g.y, g.z}};
}

Vec3f unit(const Vec3f& v) {
  const float far = std::sqrt(v.x * v.x + v.y * v.y + v.z * v.z);
  return far > 0.0f ? Vec3f{v.x / far, v.y / far, v.z / far} : Vec3f{};
}

template <class F>
std::vector<Contact> find_by_hand(const F& field, const PointShell& shell, const Pose& pose,
                                  float margin) {
  const ByHand by_hand(pose, field.reach() + reach_of(shell));
  std::vector<Contact> contacts;
  for (std::uint32_t id = 0; id < shell.size(); ++id) {
    const Vec3f p = shell.points()[id];
    const Value value = evaluate(field, by_hand.to_field(p));
    if (!(value.distance < margin)) continue;
    Vec3f normal = unit(by_hand.to_shell(value.gradient));
    if (normal == Vec3f{}) normal = -shell.normals()[id];
    contacts.push_back({id, -value.distance, p, normal});
  }
  return contacts;
}

/// A plane is taken to the shell instead, in float64.
template <>
std::vector<Contact> find_by_hand(const PlaneField& plane, const PointShell& shell,
                                  const Pose& pose, float margin) {
  const auto& [x, y, z] = pose.rotation;
  const Vec3 n = plane.normal;
  const Vec3f normal{rounded(x.x * n.x + y.x * n.y + z.x * n.z, 1.0),
                     rounded(x.y * n.x + y.y * n.y + z.y * n.z, 1.0),
                     rounded(x.z * n.x + y.z * n.y + z.z * n.z, 1.0)};
  const float offset = rounded(plane.offset - (n.x * pose.translation.x + n.y * pose.translation.y +
                                               n.z * pose.translation.z),
                               reach_of(shell));
  std::vector<Contact> contacts;
  for (std::uint32_t id = 0; id < shell.size(); ++id) {
    const Vec3f p = shell.points()[id];
    const float distance = normal.x * p.x + normal.y * p.y + normal.z * p.z - offset;
    if (distance < margin) contacts.push_back({id, -distance, p, unit(normal)});
  }
  return contacts;
}

TEST(ContactsByHand, AreTheLibrarysToTheBit) {
  Random random(110);
  QueryScratch scratch;
  int poses = 0;
  int colliding = 0;
  int outside_the_grid = 0;
  for (const PointShell& shell : shells()) {
    for (const Field& field : fields()) {
      for (int i = 0; i < 100; ++i) {
        const double clearance = random.uniform(i % 2 == 0 ? -0.25 : -0.01, 0.03);
        const Pose pose = make_pose_at(field, shell, clearance, random);
        // A large margin reaches beyond the grid as well.
        for (const float margin : {0.0f, 0.2f}) {
          const auto by_hand = std::visit(
              [&](const auto& typed) { return find_by_hand(typed, shell, pose, margin); }, field);
          const auto contacts = find_contacts(field, shell, pose, {.margin = margin}, scratch);
          ASSERT_EQ(contacts.size(), by_hand.size());
          for (std::size_t k = 0; k < by_hand.size(); ++k) {
            ASSERT_EQ(contacts[k], by_hand[k])
                << "field " << field.index() << ", point " << by_hand[k].id << ": "
                << contacts[k].depth - by_hand[k].depth;
          }
          if (margin == 0.0f) colliding += !contacts.empty();
          if (std::holds_alternative<GridField>(field) && margin > 0.0f) {
            outside_the_grid +=
                static_cast<int>(std::count_if(contacts.begin(), contacts.end(),
                                               [](const Contact& c) { return c.depth < -0.11f; }));
          }
        }
        ++poses;
      }
    }
  }
  EXPECT_GT(colliding, 0.5 * poses);
  EXPECT_GT(outside_the_grid, 10'000);
}

}  // namespace
}  // namespace voxshell::contacts_by_hand_test
