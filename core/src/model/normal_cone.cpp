#include "model/normal_cone.h"

#include <algorithm>
#include <cmath>

namespace voxshell {
namespace {

constexpr double kTiny = 1e-12;

/// Whether a direction lies between three others.
bool is_between(const Vec3& direction, const Vec3& a, const Vec3& b, const Vec3& c) {
  const Vec3 bc = cross(b, c);
  const double volume = dot(a, bc);
  if (std::abs(volume) < kTiny) return false;
  const double sign = volume > 0.0 ? 1.0 : -1.0;
  return sign * dot(direction, bc) >= 0.0 && sign * dot(direction, cross(c, a)) >= 0.0 &&
         sign * dot(direction, cross(a, b)) >= 0.0;
}

}  // namespace

double angle_of_chord(double chord) {
  // The tangent of a quarter of the angle, then of an eighth and a sixteenth.
  const double sine = std::clamp(chord / 2.0, 0.0, 1.0);
  double tangent = sine / (1.0 + std::sqrt(1.0 - sine * sine));
  for (int halving = 0; halving < 2; ++halving) {
    tangent = tangent / (1.0 + std::sqrt(1.0 + tangent * tangent));
  }
  constexpr int kTerms = 10;
  const double square = tangent * tangent;
  double series = 0.0;
  for (int term = kTerms; term-- > 0;) series = 1.0 / (2 * term + 1) - square * series;
  constexpr double kParts = 16.0;
  return kParts * tangent * series;
}

void NormalCone::add(const Vec3& normal) {
  constexpr double kSame = 1e-7;  // squared chord
  if (count_ == kMost) return;
  for (std::size_t i = 0; i < count_; ++i) {
    if (squared_length(normal - normals_[i]) < kSame) return;
  }
  normals_[count_++] = normal;
}

double NormalCone::chord_to(const Vec3& direction) const {
  double squared = kLongestChord * kLongestChord;
  for (std::size_t i = 0; i < count_; ++i) {
    const Vec3& a = normals_[i];
    squared = std::min(squared, squared_length(direction - a));
    for (std::size_t j = i + 1; j < count_; ++j) {
      const Vec3& b = normals_[j];
      const Vec3 across = cross(a, b);
      const double sine = squared_length(across);
      if (sine > kTiny) {
        // Seen along the plane of the two.
        const Vec3 in_plane = direction - (dot(direction, across) / sine) * across;
        if (dot(cross(a, in_plane), across) >= 0.0 && dot(cross(in_plane, b), across) >= 0.0) {
          squared = std::min(squared, squared_length(direction - normalized(in_plane)));
        }
      }
      for (std::size_t k = j + 1; k < count_; ++k) {
        if (is_between(direction, a, b, normals_[k])) return 0.0;
      }
    }
  }
  return std::sqrt(squared);
}

}  // namespace voxshell
