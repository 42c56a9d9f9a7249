#pragma once

#include "simd/analytic_view.h"
#include "simd/wide.h"

// Distances are exact and negative inside; gradients have unit length. Where several gradients are
// as good, one is chosen, as the fields' headers say. Of coordinates that are not numbers,
// distances are none: maximum() keeps a second argument that is none.

namespace voxshell::simd::VOXSHELL_ISA {

/// Fields whose distance is 1-Lipschitz; grids have their own.
template <class View, class F>
VOXSHELL_INLINE F evaluate_lower_bound(const View& field, const Triple<F>& p, F radius) {
  return evaluate_distance(field, p) - radius;
}

// ---- plane --------------------------------------------------------------------------------------

template <class F>
VOXSHELL_INLINE F evaluate_distance(const PlaneView& plane, const Triple<F>& p) {
  return plane.normal[0] * p.x + plane.normal[1] * p.y + plane.normal[2] * p.z - plane.offset;
}

template <class F>
VOXSHELL_INLINE Triple<F> evaluate_gradient(const PlaneView& plane, const Triple<F>&) {
  return {splat<F>(plane.normal[0]), splat<F>(plane.normal[1]), splat<F>(plane.normal[2])};
}

// ---- sphere -------------------------------------------------------------------------------------

template <class F>
VOXSHELL_INLINE F evaluate_distance(const SphereView& sphere, const Triple<F>& p) {
  return length(p) - sphere.radius;
}

template <class F>
VOXSHELL_INLINE Triple<F> evaluate_gradient(const SphereView&, const Triple<F>& p) {
  Triple<F> outwards = normalized(p);
  outwards.z = select(dot(p, p) > 0.0f, outwards.z, splat<F>(1.0f));
  return outwards;
}

// ---- box ----------------------------------------------------------------------------------------

template <class F>
VOXSHELL_INLINE Triple<F> beyond_faces(const BoxView& box, const Triple<F>& p) {
  return {absolute(p.x) - box.half_extents[0], absolute(p.y) - box.half_extents[1],
          absolute(p.z) - box.half_extents[2]};
}

template <class F>
VOXSHELL_INLINE F evaluate_distance(const BoxView& box, const Triple<F>& p) {
  const F zero = splat<F>(0.0f);
  const Triple<F> q = beyond_faces(box, p);
  const Triple<F> outside{maximum(zero, q.x), maximum(zero, q.y), maximum(zero, q.z)};
  return length(outside) + minimum(maximum(maximum(q.x, q.y), q.z), zero);
}

template <class F>
VOXSHELL_INLINE Triple<F> evaluate_gradient(const BoxView& box, const Triple<F>& p) {
  const F zero = splat<F>(0.0f);
  const F one = splat<F>(1.0f);
  const Triple<F> q = beyond_faces(box, p);
  const Triple<F> outside =
      normalized(Triple<F>{with_sign(maximum(zero, q.x), p.x), with_sign(maximum(zero, q.y), p.y),
                           with_sign(maximum(zero, q.z), p.z)});
  const auto is_x = (q.x >= q.y) & (q.x >= q.z);
  const F y = select(q.y >= q.z, one, zero);
  const Triple<F> inside{with_sign(select(is_x, one, zero), p.x),
                         with_sign(select(is_x, zero, y), p.y),
                         with_sign(select(is_x, zero, one - y), p.z)};
  return select<F>(dot(outside, outside) > 0.0f, outside, inside);
}

// ---- solids of revolution about z ---------------------------------------------------------------

/// A point in the half-plane of its distance from the z axis and z.
template <class F>
struct Profile {
  F r, z;
};

template <class F>
VOXSHELL_INLINE Profile<F> to_profile(const Triple<F>& p) {
  return {square_root(p.x * p.x + p.y * p.y), p.z};
}

/// From the half-plane of p; on the axis, that of x.
template <class F>
VOXSHELL_INLINE Triple<F> from_profile(const Profile<F>& direction, const Triple<F>& p, F r) {
  const auto is_off_axis = r > 0.0f;
  const F divisor = select(is_off_axis, r, splat<F>(1.0f));
  return {direction.r * select(is_off_axis, p.x / divisor, splat<F>(1.0f)),
          direction.r * select(is_off_axis, p.y / divisor, splat<F>(0.0f)), direction.z};
}

template <class F>
VOXSHELL_INLINE F squared_length(const Profile<F>& a) {
  return a.r * a.r + a.z * a.z;
}

template <class F>
VOXSHELL_INLINE Profile<F> select(MaskOf<F> mask, const Profile<F>& a, const Profile<F>& b) {
  return {select(mask, a.r, b.r), select(mask, a.z, b.z)};
}

/// Unit vector along `a`, or `otherwise` where `a` is zero.
template <class F>
VOXSHELL_INLINE Profile<F> normalized_or(const Profile<F>& a, const Profile<F>& otherwise) {
  const F l = square_root(squared_length(a));
  const auto is_long = l > 0.0f;
  const F divisor = select(is_long, l, splat<F>(1.0f));
  return select<F>(is_long, Profile<F>{a.r / divisor, a.z / divisor}, otherwise);
}

template <class F>
VOXSHELL_INLINE F clamp(F value, float low, float high) {
  return minimum(maximum(value, splat<F>(low)), splat<F>(high));
}

// ---- capsule ------------------------------------------------------------------------------------

/// From the nearest point of the segment between the caps' centers.
template <class F>
VOXSHELL_INLINE Profile<F> from_segment(const CapsuleView& capsule, const Triple<F>& p) {
  const Profile<F> q = to_profile(p);
  return {q.r, q.z - clamp(q.z, -capsule.half_length, capsule.half_length)};
}

template <class F>
VOXSHELL_INLINE F evaluate_distance(const CapsuleView& capsule, const Triple<F>& p) {
  return square_root(squared_length(from_segment(capsule, p))) - capsule.radius;
}

template <class F>
VOXSHELL_INLINE Triple<F> evaluate_gradient(const CapsuleView& capsule, const Triple<F>& p) {
  const Profile<F> outwards = from_segment(capsule, p);
  const Profile<F> sideways{splat<F>(1.0f), splat<F>(0.0f)};
  return from_profile(normalized_or(outwards, sideways), p, outwards.r);
}

// ---- cylinder -----------------------------------------------------------------------------------

/// Beyond the side and beyond the nearer end.
template <class F>
VOXSHELL_INLINE Profile<F> beyond_faces(const CylinderView& cylinder, const Profile<F>& q) {
  return {q.r - cylinder.radius, absolute(q.z) - cylinder.half_length};
}

template <class F>
VOXSHELL_INLINE F evaluate_distance(const CylinderView& cylinder, const Triple<F>& p) {
  const F zero = splat<F>(0.0f);
  const Profile<F> beyond = beyond_faces(cylinder, to_profile(p));
  const Profile<F> outside{maximum(zero, beyond.r), maximum(zero, beyond.z)};
  return square_root(squared_length(outside)) + minimum(maximum(beyond.r, beyond.z), zero);
}

template <class F>
VOXSHELL_INLINE Triple<F> evaluate_gradient(const CylinderView& cylinder, const Triple<F>& p) {
  const F zero = splat<F>(0.0f);
  const F one = splat<F>(1.0f);
  const Profile<F> q = to_profile(p);
  const Profile<F> beyond = beyond_faces(cylinder, q);
  const auto is_side = beyond.r >= beyond.z;
  const Profile<F> inside{select(is_side, one, zero), select(is_side, zero, one)};
  const Profile<F> outside{maximum(zero, beyond.r), maximum(zero, beyond.z)};
  Profile<F> direction = normalized_or(outside, inside);
  direction.z = with_sign(direction.z, q.z);
  return from_profile(direction, p, q.r);
}

// ---- cone ---------------------------------------------------------------------------------------

/// How a point lies to the triangle that a cone is made of by turning.
template <class F>
struct ConePlace {
  F beyond_base;       ///< meters below it
  F beyond_slant;      ///< meters out of its plane
  Profile<F> outside;  ///< from the nearest point of the boundary
  F squared_distance;  ///< of the same
};

template <class F>
VOXSHELL_INLINE ConePlace<F> locate(const ConeView& cone, const Profile<F>& q) {
  const Profile<F> from_rim{q.r - cone.radius, q.z + cone.half_height};
  const F along =
      clamp(from_rim.r * cone.slant_r + from_rim.z * cone.slant_z, 0.0f, cone.slant_length);
  const Profile<F> from_slant{from_rim.r - along * cone.slant_r, from_rim.z - along * cone.slant_z};
  const Profile<F> from_base{maximum(splat<F>(0.0f), from_rim.r), from_rim.z};
  const F squared_slant = squared_length(from_slant);
  const F squared_base = squared_length(from_base);
  const auto is_base = squared_base < squared_slant;
  return {-from_rim.z, from_rim.r * cone.slant_z - from_rim.z * cone.slant_r,
          select<F>(is_base, from_base, from_slant), minimum(squared_base, squared_slant)};
}

template <class F>
VOXSHELL_INLINE F evaluate_distance(const ConeView& cone, const Triple<F>& p) {
  const ConePlace<F> place = locate(cone, to_profile(p));
  const F beyond = maximum(place.beyond_base, place.beyond_slant);
  return select(beyond > 0.0f, square_root(place.squared_distance), beyond);
}

template <class F>
VOXSHELL_INLINE Triple<F> evaluate_gradient(const ConeView& cone, const Triple<F>& p) {
  const F zero = splat<F>(0.0f);
  const Profile<F> q = to_profile(p);
  const ConePlace<F> place = locate(cone, q);
  const auto is_base = place.beyond_base > place.beyond_slant;
  const Profile<F> face{select(is_base, zero, splat<F>(cone.slant_z)),
                        select(is_base, splat<F>(-1.0f), splat<F>(-cone.slant_r))};
  const auto is_outside = maximum(place.beyond_base, place.beyond_slant) > 0.0f;
  const Profile<F> outside{select(is_outside, place.outside.r, zero),
                           select(is_outside, place.outside.z, zero)};
  return from_profile(normalized_or(outside, face), p, q.r);
}

// ---- convex polyhedron --------------------------------------------------------------------------

template <class F>
struct FarthestFace {
  F distance;
  Triple<F> normal;
};

/// The face whose plane is farthest below the point; the first of equals.
template <class F>
VOXSHELL_INLINE FarthestFace<F> find_farthest_face(const ConvexView& convex, const Triple<F>& p) {
  const auto normal_of = [&](const float* plane) {
    return Triple<F>{splat<F>(plane[0]), splat<F>(plane[1]), splat<F>(plane[2])};
  };
  const float* plane = convex.planes;
  FarthestFace<F> face{dot(normal_of(plane), p) - plane[3], normal_of(plane)};
  for (int32_t i = 1; i < convex.plane_count; ++i) {
    plane += 4;
    const F distance = dot(normal_of(plane), p) - plane[3];
    const auto is_farther = distance > face.distance;
    face.distance = select(is_farther, distance, face.distance);
    face.normal = select<F>(is_farther, normal_of(plane), face.normal);
  }
  return face;
}

template <class F>
VOXSHELL_INLINE F evaluate_distance(const ConvexView& convex, const Triple<F>& p) {
  return find_farthest_face(convex, p).distance;
}

template <class F>
VOXSHELL_INLINE Triple<F> evaluate_gradient(const ConvexView& convex, const Triple<F>& p) {
  return find_farthest_face(convex, p).normal;
}

}  // namespace voxshell::simd::VOXSHELL_ISA
