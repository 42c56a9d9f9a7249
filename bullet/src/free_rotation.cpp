#include "voxshell/bullet/free_rotation.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>

#include "voxshell/bullet/convert.h"

namespace voxshell::bullet {
namespace {

/// Radians that a piece of the way turns by at most. The series converges like its powers: with
/// more, kMostTerms do not reach rounding errors.
constexpr double kPiece = 0.25;
/// 0.25^27 is below half a unit in the last place.
constexpr std::size_t kMostTerms = 28;
/// Terms below this fraction of the first change nothing any more.
constexpr double kNothing = 1e-17;

struct Quaternion {
  double w = 1.0;
  Vec3 v;

  friend Quaternion operator*(const Quaternion& a, const Quaternion& b) {
    return {a.w * b.w - dot(a.v, b.v), a.w * b.v + b.w * a.v + cross(a.v, b.v)};
  }
  Quaternion& operator+=(const Quaternion& q) {
    w += q.w;
    v += q.v;
    return *this;
  }
};

double largest(const Vec3& v) { return std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)}); }

/// Solves Euler's equations and those of the orientation by their power series in the time, of
/// which 1 is a piece. `turn` is the angular velocity, radians a piece, body frame.
///
/// @param ratios  (I_y - I_z) / I_x and so on.
/// @return The orientation at the end, as seen from that at the start; `turn` is that of the end.
Quaternion turn_a_piece(const Vec3& ratios, Vec3& turn) {
  std::array<Vec3, kMostTerms> w;
  std::array<Quaternion, kMostTerms> q;
  w[0] = turn;
  Quaternion end;
  const double size = largest(turn);
  for (std::size_t k = 0; k + 1 < kMostTerms; ++k) {
    Vec3 products;
    Quaternion rate{0.0, {}};
    for (std::size_t j = 0; j <= k; ++j) {
      const Vec3& a = w[j];
      const Vec3& b = w[k - j];
      products += Vec3{a.y * b.z, a.z * b.x, a.x * b.y};
      rate += q[j] * Quaternion{0.0, b};
    }
    const double inverse = 1.0 / static_cast<double>(k + 1);
    w[k + 1] = inverse * Vec3{ratios.x * products.x, ratios.y * products.y, ratios.z * products.z};
    q[k + 1] = {0.5 * inverse * rate.w, 0.5 * inverse * rate.v};
    turn += w[k + 1];
    end += q[k + 1];
    const double of_orientation = std::max(std::abs(q[k + 1].w), largest(q[k + 1].v));
    if (largest(w[k + 1]) <= kNothing * size && of_orientation <= kNothing) break;
  }
  return end;
}

}  // namespace

bool rotate_freely(Rotation& rotation, const btVector3& inverse_inertia, btScalar time) {
  const Vec3 inverse = from_bullet(inverse_inertia);
  const Vec3 inertia{1.0 / inverse.x, 1.0 / inverse.y, 1.0 / inverse.z};
  const Vec3 before = from_bullet(rotation.world_from_body.transpose() * rotation.angular_velocity);
  const Vec3 momentum{inertia.x * before.x, inertia.y * before.y, inertia.z * before.z};
  // The energy bounds how fast the body may come to turn.
  const double least = std::min({inertia.x, inertia.y, inertia.z});
  const double most_turn = std::sqrt(dot(momentum, before) / least) * static_cast<double>(time);
  if (!(most_turn <= 2.0 * std::numbers::pi)) return false;

  const int pieces = std::max(static_cast<int>(std::ceil(most_turn / kPiece)), 1);
  const Vec3 ratios{(inertia.y - inertia.z) * inverse.x, (inertia.z - inertia.x) * inverse.y,
                    (inertia.x - inertia.y) * inverse.z};
  Vec3 turn = (static_cast<double>(time) / pieces) * before;
  Quaternion start_from_end;
  for (int i = 0; i < pieces; ++i) start_from_end = start_from_end * turn_a_piece(ratios, turn);

  btQuaternion start;
  rotation.world_from_body.getRotation(start);
  const Quaternion world_from_start{static_cast<double>(start.w()),
                                    from_bullet(btVector3(start.x(), start.y(), start.z()))};
  const Quaternion end = world_from_start * start_from_end;
  const btVector3 vector = to_bullet(end.v);
  btQuaternion world_from_body(vector.x(), vector.y(), vector.z(), static_cast<btScalar>(end.w));
  world_from_body.normalize();
  const btVector3 momentum_world = rotation.world_from_body * to_bullet(momentum);
  rotation.world_from_body.setRotation(world_from_body);
  // From the momentum, so that rounding errors of the way do not add up in it.
  rotation.angular_velocity =
      rotation.world_from_body *
      ((rotation.world_from_body.transpose() * momentum_world) * inverse_inertia);
  return true;
}

}  // namespace voxshell::bullet
