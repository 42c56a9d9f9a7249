#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <type_traits>

#include "base/little_endian.h"
#include "voxshell/point_sphere_tree.h"
#include "voxshell/triangle_mesh.h"
#include "voxshell/vector.h"

namespace voxshell::model_format {

// A model file: a header, a table of its sections, and the sections one after the other, each
// filled up with zeros to a multiple of kAlignment. Their kinds, order and item sizes are those of
// visit_sections(), so that the counts decide every other number of the table, which are there for
// other readers and as a check. All numbers are little-endian. Any change of what is written needs
// another kVersion.

/// The first byte is no letter, and the line ends show whether the file went through something
/// that changes them.
inline constexpr std::array<std::uint8_t, 8> kMagic{0x89, 'V', 'X', 'S', '\r', '\n', 0x1a, '\n'};
inline constexpr std::uint32_t kVersion = 8;
inline constexpr std::uint64_t kAlignment = 64;

inline constexpr std::uint64_t align(std::uint64_t size) {
  return (size + kAlignment - 1) / kAlignment * kAlignment;
}

struct Header {
  std::array<std::uint8_t, 8> magic;
  std::uint64_t checksum;  ///< of the file from kChecksumFrom on
  std::array<std::uint64_t, 2> zeros;
  std::uint32_t version;
  std::uint32_t section_count;
  std::uint64_t file_size;  ///< bytes
  std::array<std::uint64_t, 2> more_zeros;
};
static_assert(sizeof(Header) == kAlignment);
inline constexpr std::size_t kChecksumFrom = offsetof(Header, version);

/// From this machine's order of bytes to the file's, and back.
inline Header little_endian(Header header) {
  header.checksum = voxshell::little_endian(header.checksum);
  header.version = voxshell::little_endian(header.version);
  header.section_count = voxshell::little_endian(header.section_count);
  header.file_size = voxshell::little_endian(header.file_size);
  return header;
}

struct TableEntry {
  std::uint32_t kind;
  std::uint32_t item_size;  ///< bytes
  std::uint64_t offset;     ///< from the beginning of the file, bytes
  std::uint64_t count;      ///< of items
  std::uint64_t zero;

  friend bool operator==(const TableEntry&, const TableEntry&) = default;
};
static_assert(sizeof(TableEntry) == 32);

inline TableEntry little_endian(const TableEntry& entry) {
  return {voxshell::little_endian(entry.kind), voxshell::little_endian(entry.item_size),
          voxshell::little_endian(entry.offset), voxshell::little_endian(entry.count),
          voxshell::little_endian(entry.zero)};
}

/// All values that are not arrays. Meters.
struct Record {
  // The settings that the model was built with.
  double tolerance;
  double voxel_size;
  std::int64_t resolution;
  double point_spacing;
  std::uint64_t target_points;
  double padding;
  std::int64_t sign;  ///< SignMethod
  std::int64_t open;  ///< OpenMesh
  double sheet_thickness;
  // The grid field.
  double grid_voxel_size;
  Vec3 grid_origin;
  std::array<std::int64_t, 3> grid_bricks;
  Vec3 grid_surface_lower;
  Vec3 grid_surface_upper;
  std::uint64_t grid_quanta_per_voxel;
  double grid_node_error;
  double grid_surface_error;
  std::array<double, 3> grid_coarse_floors;
  // Its SignReport.
  std::int64_t sign_method;
  double sign_confidence;
  std::uint64_t sign_was_turned;
  std::array<std::uint64_t, 3> sign_defects;  ///< open, non-manifold, flipped
  std::uint64_t sign_overlaps;
  std::uint64_t sign_hidden_triangles;
  Vec3 sign_first_defect;
  Vec3 sign_first_location;
  double sign_cap_error;
  // The point shell.
  double shell_spacing;
  double edge_tolerance;  ///< 0 where there are no edge segments
  // The mesh that it was built from.
  std::uint64_t openings_loops;
  double openings_fraction;
  std::uint64_t openings_mouths;
  double openings_largest_diameter;
  Vec3 openings_first_location;
  double openings_sheet_thickness;
  // How exact all this is.
  std::uint64_t accuracy_places;
  std::array<double, 9> accuracy_errors;  ///< distance, normal, coverage: median, 99 %, worst
  double accuracy_gap;
  std::uint64_t accuracy_is_sharp;
  double accuracy_curvature;
  double thickness;
};
static_assert(sizeof(Record) == std::size_t{67} * 8);

/// The contents of a file. Array<T> is a std::vector<T> to read into or a span to write from.
template <template <class> class Array>
struct Sections {
  Array<Record> record;
  Array<Vec3> vertices;
  Array<Triangle> triangles;
  Array<std::uint32_t> brick_entries;
  Array<std::int16_t> samples;
  Array<float> planes;
  Array<Vec3f> points;
  Array<Vec3f> normals;
  Array<float> areas;
  Array<Sphere> spheres;
  Array<float> blocks;
  Array<std::uint32_t> exact_bricks;
  Array<std::uint32_t> exact_masks;
  Array<std::uint32_t> exact_lists;
  Array<std::uint32_t> listed_triangles;
  Array<float> exact_triangles;
  Array<float> feature_normals;
  // Of the edge segments, empty where there are none.
  Array<Vec3f> edge_middles;
  Array<Vec3f> edge_halves;
  Array<Vec3f> edge_normals;
  Array<Sphere> edge_spheres;
  Array<float> edge_blocks;
};
inline constexpr std::uint32_t kSectionCount = 22;

/// Calls `visit(kind, name, array)` for each section in the file's order until it returns false.
/// Returns false where it did.
template <class AnySections, class Visit>
bool visit_sections(AnySections& s, const Visit& visit) {
  return visit(1u, "record", s.record) && visit(2u, "vertices", s.vertices) &&
         visit(3u, "triangles", s.triangles) && visit(4u, "brick entries", s.brick_entries) &&
         visit(5u, "samples", s.samples) && visit(6u, "planes", s.planes) &&
         visit(7u, "points", s.points) && visit(8u, "normals", s.normals) &&
         visit(9u, "areas", s.areas) && visit(10u, "spheres", s.spheres) &&
         visit(11u, "sphere blocks", s.blocks) &&
         visit(12u, "bricks with exact cells", s.exact_bricks) &&
         visit(13u, "masks of exact cells", s.exact_masks) &&
         visit(14u, "lists of exact cells", s.exact_lists) &&
         visit(15u, "listed triangles", s.listed_triangles) &&
         visit(16u, "exact triangles", s.exact_triangles) &&
         visit(17u, "feature normals", s.feature_normals) &&
         visit(18u, "edge middles", s.edge_middles) && visit(19u, "edge halves", s.edge_halves) &&
         visit(20u, "edge normals", s.edge_normals) && visit(21u, "edge spheres", s.edge_spheres) &&
         visit(22u, "edge sphere blocks", s.edge_blocks);
}

inline constexpr std::uint64_t kTableEnd =
    align(sizeof(Header) + kSectionCount * sizeof(TableEntry));

/// Bytes of each of the numbers that an item consists of, which lie in memory as in the file, but
/// for their order of bytes on big-endian machines.
template <class Item>
inline constexpr std::size_t kWordSize = sizeof(Item);
template <>
inline constexpr std::size_t kWordSize<Record> = 8;
template <>
inline constexpr std::size_t kWordSize<Vec3> = 8;
template <>
inline constexpr std::size_t kWordSize<Vec3f> = 4;
template <>
inline constexpr std::size_t kWordSize<Triangle> = 4;
template <>
inline constexpr std::size_t kWordSize<Sphere> = 4;

static_assert(sizeof(Vec3) == 24 && sizeof(Vec3f) == 12 && sizeof(Triangle) == 12 &&
              sizeof(Sphere) == 16);
static_assert(std::is_trivially_copyable_v<Record> && std::is_trivially_copyable_v<Vec3> &&
              std::is_trivially_copyable_v<Sphere>);

}  // namespace voxshell::model_format
