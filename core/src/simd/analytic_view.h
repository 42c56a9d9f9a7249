#pragma once

#include <stdint.h>

namespace voxshell::simd {

// Analytic fields as kernels see them: solids in their own frame, meters.

struct PlaneView {
  float normal[3];  ///< unit length, out of the solid
  float offset;

  friend bool operator==(const PlaneView&, const PlaneView&) = default;
};

struct BoxView {
  float half_extents[3];

  friend bool operator==(const BoxView&, const BoxView&) = default;
};

struct SphereView {
  float radius;

  friend bool operator==(const SphereView&, const SphereView&) = default;
};

struct CapsuleView {
  float radius;
  float half_length;  ///< of the segment between the caps' centers, along z

  friend bool operator==(const CapsuleView&, const CapsuleView&) = default;
};

struct CylinderView {
  float radius;
  float half_length;  ///< along z

  friend bool operator==(const CylinderView&, const CylinderView&) = default;
};

struct ConeView {
  float radius;       ///< of the base, at z = -half_height
  float half_height;  ///< the apex is at z = half_height
  /// Along the slant from the base's rim to the apex, in the half-plane of the radius and z: unit
  /// length, and the length of the slant. Its outward normal is (slant_z, -slant_r).
  float slant_r;
  float slant_z;
  float slant_length;

  friend bool operator==(const ConeView&, const ConeView&) = default;
};

struct ConvexView {
  uint64_t serial;      ///< of the field; see base/serial.h
  const float* planes;  ///< outward unit normal x, y, z and offset of each
  int32_t plane_count;  ///< at least one

  friend bool operator==(const ConvexView&, const ConvexView&) = default;
};

}  // namespace voxshell::simd
