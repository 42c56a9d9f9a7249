#include "voxshell/mass_properties.h"

namespace voxshell {
namespace {

/// First and second moments of a distribution about some origin.
struct Moments {
  double total = 0.0;  ///< mass
  Vec3 first{};        ///< integral of x
  Vec3 squares{};      ///< integrals of x^2, y^2, z^2
  Vec3 products{};     ///< integrals of yz, zx, xy

  /// Adds a simplex whose density is uniform: the integral of p p^T over a simplex with corners
  /// v_i is weight / (k (k + 1)) (s s^T + sum v_i v_i^T), with s their sum and k their number.
  template <std::size_t Corners>
  void add_simplex(double weight, const std::array<Vec3, Corners>& corners) {
    constexpr double kCorners = static_cast<double>(Corners);
    Vec3 sum{};
    for (const Vec3& v : corners) sum += v;
    const double scale = weight / (kCorners * (kCorners + 1.0));
    const auto add_outer = [&](const Vec3& v) {
      squares += scale * Vec3{v.x * v.x, v.y * v.y, v.z * v.z};
      products += scale * Vec3{v.y * v.z, v.z * v.x, v.x * v.y};
    };
    add_outer(sum);
    for (const Vec3& v : corners) add_outer(v);
    total += weight;
    first += (weight / kCorners) * sum;
  }

  MassProperties at_unit_mass(const Vec3& origin) const {
    const Vec3 c = first / total;
    const Vec3 s = squares / total - Vec3{c.x * c.x, c.y * c.y, c.z * c.z};
    const Vec3 p = products / total - Vec3{c.y * c.z, c.z * c.x, c.x * c.y};
    return {1.0,
            origin + c,
            {{s.y + s.z, -p.z, -p.y}, {-p.z, s.z + s.x, -p.x}, {-p.y, -p.x, s.x + s.y}}};
  }
};

}  // namespace

MassProperties MassProperties::with_mass(double new_mass) const {
  const double ratio = new_mass / mass;
  return {new_mass,
          center_of_mass,
          {inertia.row_x * ratio, inertia.row_y * ratio, inertia.row_z * ratio}};
}

MassProperties compute_solid_mass_properties(const TriangleMesh& mesh) {
  const Vec3 origin = mesh.bounds().center();
  Moments moments;
  for (std::size_t i = 0; i < mesh.triangles().size(); ++i) {
    const auto [a, b, c] = mesh.corners(i);
    const std::array<Vec3, 4> tetrahedron{a - origin, b - origin, c - origin, Vec3{}};
    const double volume = dot(tetrahedron[0], cross(tetrahedron[1], tetrahedron[2])) / 6.0;
    moments.add_simplex(volume, tetrahedron);
  }
  return moments.at_unit_mass(origin);
}

MassProperties compute_surface_mass_properties(const TriangleMesh& mesh) {
  const Vec3 origin = mesh.bounds().center();
  Moments moments;
  for (std::size_t i = 0; i < mesh.triangles().size(); ++i) {
    const auto [a, b, c] = mesh.corners(i);
    const double area = length(cross(b - a, c - a)) / 2.0;
    moments.add_simplex(area, std::array<Vec3, 3>{a - origin, b - origin, c - origin});
  }
  return moments.at_unit_mass(origin);
}

}  // namespace voxshell
