#pragma once

#include <variant>

#include "voxshell/box_field.h"
#include "voxshell/capsule_field.h"
#include "voxshell/cone_field.h"
#include "voxshell/convex_field.h"
#include "voxshell/cylinder_field.h"
#include "voxshell/grid_field.h"
#include "voxshell/plane_field.h"
#include "voxshell/sphere_field.h"

namespace voxshell {

/// Any signed distance field. Every alternative offers
///   float distance(Vec3f)             meters, negative inside, body frame
///   Vec3f gradient(Vec3f)             outward; unit length where the field is analytic
///   float lower_bound(Vec3f, float)   of the distance over a ball
///   double reach()                    scale of its coordinates, for rounding bounds
///   view()                            itself as kernels see it (simd/*_view.h)
/// To add a field, add it to this list, and its view to the list in simd/query_kernels.h.
using Field = std::variant<GridField, PlaneField, BoxField, SphereField, CapsuleField,
                           CylinderField, ConeField, ConvexField>;

}  // namespace voxshell
