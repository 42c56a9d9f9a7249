#include "model/write_model.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <cstring>
#include <vector>

#include "base/checksum.h"
#include "base/little_endian.h"
#include "model/model_format.h"

namespace voxshell {
namespace {

using namespace model_format;

template <class T>
using View = std::span<const T>;

Record make_record(const Model& model) {
  const ModelSettings& settings = model.settings();
  const GridFieldData& grid = model.grid().data();
  const PointShell& shell = model.shell();
  const Accuracy& accuracy = model.accuracy();
  const Openings& openings = model.openings();
  return {
      .tolerance = settings.tolerance,
      .voxel_size = settings.voxel_size,
      .resolution = settings.resolution,
      .point_spacing = settings.point_spacing,
      .target_points = settings.target_points,
      .padding = settings.padding,
      .sign = static_cast<std::int64_t>(settings.sign),
      .open = static_cast<std::int64_t>(settings.open),
      .sheet_thickness = settings.sheet_thickness,
      .grid_voxel_size = grid.voxel_size,
      .grid_origin = grid.origin,
      .grid_bricks = {grid.bricks[0], grid.bricks[1], grid.bricks[2]},
      .grid_surface_lower = grid.surface_bounds.lower,
      .grid_surface_upper = grid.surface_bounds.upper,
      .grid_quanta_per_voxel = static_cast<std::uint64_t>(grid.quanta_per_voxel),
      .grid_node_error = grid.node_error,
      .grid_surface_error = grid.surface_error,
      .grid_coarse_floors = grid.coarse_floors,
      .sign_method = static_cast<std::int64_t>(grid.sign.method),
      .sign_confidence = grid.sign.confidence,
      .sign_was_turned = grid.sign.was_turned ? 1u : 0u,
      .sign_defects = {grid.sign.defects.open_edges, grid.sign.defects.non_manifold_edges,
                       grid.sign.defects.flipped_edges},
      .sign_overlaps = grid.sign.overlaps,
      .sign_hidden_triangles = grid.sign.hidden_triangles,
      .sign_first_defect = grid.sign.defects.first_location,
      .sign_first_location = grid.sign.first_location,
      .sign_cap_error = grid.sign.cap_error,
      .shell_spacing = shell.spacing(),
      .edge_tolerance = shell.edges() == nullptr ? 0.0 : shell.edges()->tolerance(),
      .openings_loops = openings.loops,
      .openings_fraction = openings.fraction,
      .openings_mouths = openings.mouths,
      .openings_largest_diameter = openings.largest_diameter,
      .openings_first_location = openings.first_location,
      .openings_sheet_thickness = openings.sheet_thickness,
      .accuracy_places = accuracy.places,
      .accuracy_errors = {accuracy.distance.median, accuracy.distance.p99, accuracy.distance.worst,
                          accuracy.normal.median, accuracy.normal.p99, accuracy.normal.worst,
                          accuracy.coverage.median, accuracy.coverage.p99, accuracy.coverage.worst},
      .accuracy_gap = accuracy.gap,
      .accuracy_is_sharp = accuracy.is_sharp ? 1u : 0u,
      .accuracy_curvature = accuracy.curvature,
      .thickness = model.thickness()};
}

/// The tree holds them coordinate by coordinate.
std::vector<Vec3f> copy_points(const BucketPoints& in_buckets) {
  std::vector<Vec3f> points;
  points.reserve(in_buckets.size());
  points.assign(in_buckets.begin(), in_buckets.end());
  return points;
}

/// `points` are the shell's, `edge_middles` those of its edges.
Sections<View> view_sections(const Model& model, const Record& record, View<Vec3f> points,
                             View<Vec3f> edge_middles) {
  const GridFieldData& grid = model.grid().data();
  const PointShell& shell = model.shell();
  const EdgeSegments* edges = shell.edges();
  const bool has_edges = edges != nullptr;
  return {.record = View<Record>(&record, 1),
          .vertices = model.mesh().vertices(),
          .triangles = model.mesh().triangles(),
          .brick_entries = grid.entries,
          .samples = grid.samples,
          .planes = grid.planes,
          .points = points,
          .normals = shell.normals(),
          .areas = shell.areas(),
          .spheres = shell.tree().spheres(),
          .blocks = shell.tree().blocks(),
          .exact_bricks = grid.exact.bricks,
          .exact_masks = grid.exact.masks,
          .exact_lists = grid.exact.lists,
          .listed_triangles = grid.exact.listed,
          .exact_triangles = grid.exact.triangles,
          .feature_normals = grid.exact.feature_normals,
          .edge_middles = edge_middles,
          .edge_halves = has_edges ? edges->halves() : View<Vec3f>{},
          .edge_normals = has_edges ? edges->normals() : View<Vec3f>{},
          .edge_spheres = has_edges ? edges->tree().spheres() : View<Sphere>{},
          .edge_blocks = has_edges ? edges->tree().blocks() : View<float>{}};
}

/// The header, without its checksum, and the table.
std::vector<std::byte> make_front(const Sections<View>& sections) {
  Header header{.magic = kMagic,
                .checksum = 0,
                .zeros = {},
                .version = kVersion,
                .section_count = kSectionCount,
                .file_size = kTableEnd,
                .more_zeros = {}};
  std::vector<TableEntry> table;
  visit_sections(sections, [&]<class T>(std::uint32_t kind, const char*, View<T> array) {
    table.push_back(little_endian(TableEntry{kind, sizeof(T), header.file_size, array.size(), 0}));
    header.file_size += align(array.size_bytes());
    return true;
  });
  std::vector<std::byte> front(kTableEnd);
  header = little_endian(header);
  std::memcpy(front.data(), &header, sizeof header);
  std::memcpy(front.data() + sizeof header, table.data(), table.size() * sizeof(TableEntry));
  return front;
}

/// Whole lines of kAlignment bytes, as they are on little-endian machines.
Result<std::monostate> append_lines(std::span<const std::byte> bytes, std::size_t word_size,
                                    const Append& append) {
  if constexpr (std::endian::native == std::endian::little) {
    return append(bytes);
  } else {
    std::array<std::byte, 256 * kAlignment> part;
    while (!bytes.empty()) {
      const auto turned = std::span(part).first(std::min(part.size(), bytes.size()));
      std::ranges::copy(bytes.first(turned.size()), turned.begin());
      turn_little_endian(turned, word_size);
      if (auto done = append(turned); !done) return done;
      bytes = bytes.subspan(turned.size());
    }
    return std::monostate{};
  }
}

/// Every call of `append` gets a multiple of kAlignment bytes.
Result<std::monostate> append_sections(const Sections<View>& sections, const Append& append) {
  Result<std::monostate> result = std::monostate{};
  visit_sections(sections, [&]<class T>(std::uint32_t, const char*, View<T> array) {
    const auto bytes = std::as_bytes(array);
    const std::size_t whole = bytes.size() / kAlignment * kAlignment;
    result = append_lines(bytes.first(whole), kWordSize<T>, append);
    if (result && whole < bytes.size()) {
      std::array<std::byte, kAlignment> end{};
      std::memcpy(end.data(), bytes.data() + whole, bytes.size() - whole);
      result = append_lines(end, kWordSize<T>, append);
    }
    return result.has_value();
  });
  return result;
}

}  // namespace

Result<std::monostate> write_model(const Model& model, const Append& append) {
  const Record record = make_record(model);
  const std::vector<Vec3f> points = copy_points(model.shell().points());
  const EdgeSegments* edges = model.shell().edges();
  const std::vector<Vec3f> edge_middles =
      edges == nullptr ? std::vector<Vec3f>{} : copy_points(edges->middles());
  const Sections<View> sections = view_sections(model, record, points, edge_middles);
  std::vector<std::byte> front = make_front(sections);

  Checksum checksum;
  checksum.add(std::span(front).subspan(kChecksumFrom));
  auto summed = append_sections(sections, [&](std::span<const std::byte> bytes) {
    checksum.add(bytes);
    return std::monostate{};
  });
  if (!summed) return summed;
  const std::uint64_t value = little_endian(checksum.value());
  std::memcpy(front.data() + offsetof(Header, checksum), &value, sizeof value);

  if (auto written = append(front); !written) return written;
  return append_sections(sections, append);
}

}  // namespace voxshell
