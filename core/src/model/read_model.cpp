#include "model/read_model.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <limits>
#include <new>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "base/checksum.h"
#include "base/little_endian.h"
#include "base/text.h"
#include "field/grid_field_check.h"
#include "model/model_format.h"

namespace voxshell {
namespace {

using namespace model_format;

template <class T>
using Array = std::vector<T>;

template <class... Args>
Error invalid(const char* format, Args... args) {
  return {ErrorCode::kInvalidFile, format_text(format, args...)};
}

/// For messages: printf has no name of its own for 64 bits.
unsigned long long number(std::uint64_t value) { return value; }

bool is_zero(std::span<const std::byte> bytes) {
  return std::all_of(bytes.begin(), bytes.end(), [](std::byte b) { return b == std::byte{0}; });
}

class Reader {
 public:
  Reader(std::uint64_t size, const ReadAt& read_at) : size_(size), read_at_(read_at) {}

  /// All sections, of which nothing is known yet but that they are what was written.
  Result<Sections<Array>> read() {
    if (auto checked = read_header(); !checked) return checked.error();
    if (auto checked = read_table(); !checked) return checked.error();
    Sections<Array> sections;
    std::optional<Error> error;
    visit_sections(sections, [&]<class T>(std::uint32_t kind, const char* name, Array<T>& array) {
      array.resize(static_cast<std::size_t>(table_[kind - 1].count));
      if (auto done =
              read_section(table_[kind - 1], name, std::as_writable_bytes(std::span(array)));
          !done) {
        error = done.error();
      }
      turn_little_endian(std::as_writable_bytes(std::span(array)), kWordSize<T>);
      return !error;
    });
    if (error) return *error;
    if (checksum_.value() != header_.checksum) {
      return invalid("it is damaged: the checksum is %016llx, but should be %016llx",
                     number(checksum_.value()), number(header_.checksum));
    }
    return sections;
  }

 private:
  Result<std::monostate> read_header() {
    if (size_ < sizeof header_) {
      return invalid("not a model file: it has %llu bytes, and a header takes %zu", number(size_),
                     sizeof header_);
    }
    std::array<std::byte, sizeof header_> bytes{};
    if (auto done = read_at_(0, bytes); !done) return done;
    std::memcpy(&header_, bytes.data(), sizeof header_);
    header_ = little_endian(header_);
    if (header_.magic != kMagic) {
      return invalid("not a model file: it does not begin with the signature of one");
    }
    if (header_.version != kVersion) {
      return invalid(
          "it has version %u of the format, this is a reader of version %u; build the "
          "model again",
          header_.version, kVersion);
    }
    if (header_.file_size != size_) {
      return invalid("it has %llu bytes, but was written with %llu", number(size_),
                     number(header_.file_size));
    }
    if (header_.section_count != kSectionCount) {
      return invalid("its header says %u sections, there are %u", header_.section_count,
                     kSectionCount);
    }
    if (header_.zeros != std::array<std::uint64_t, 2>{} ||
        header_.more_zeros != std::array<std::uint64_t, 2>{}) {
      return invalid("its header has bits set where there should be none");
    }
    if (size_ < kTableEnd) {
      return invalid("it has %llu bytes, the table alone ends at %llu", number(size_),
                     number(kTableEnd));
    }
    checksum_.add(std::span(bytes).subspan(kChecksumFrom));
    return std::monostate{};
  }

  Result<std::monostate> read_table() {
    std::array<std::byte, kTableEnd - sizeof(Header)> bytes{};
    if (auto done = read_at_(sizeof(Header), bytes); !done) return done;
    checksum_.add(bytes);
    std::memcpy(table_.data(), bytes.data(), sizeof table_);
    for (TableEntry& entry : table_) entry = little_endian(entry);
    if (!is_zero(std::span(bytes).subspan(sizeof table_))) {
      return invalid("its table has bits set where there should be none");
    }
    std::uint64_t offset = kTableEnd;
    std::optional<Error> error;
    Sections<Array> none;
    visit_sections(none, [&]<class T>(std::uint32_t kind, const char* name, const Array<T>&) {
      const TableEntry& entry = table_[kind - 1];
      if (entry != TableEntry{kind, sizeof(T), offset, entry.count, 0}) {
        error = invalid(
            "its table says kind %u, item size %u and offset %llu of the %s, which should be %u, "
            "%zu and %llu",
            entry.kind, entry.item_size, number(entry.offset), name, kind, sizeof(T),
            number(offset));
        return false;
      }
      // No product is formed before it is known to fit.
      if (entry.count > (size_ - offset) / sizeof(T)) {
        error = invalid("its table says %llu %s, more than the file has room for",
                        number(entry.count), name);
        return false;
      }
      offset += align(entry.count * sizeof(T));
      if (offset > size_) {
        error = invalid("its %s end after the file does", name);
        return false;
      }
      return true;
    });
    if (error) return *error;
    if (offset != size_) {
      return invalid("its sections end at byte %llu, but it has %llu bytes", number(offset),
                     number(size_));
    }
    return std::monostate{};
  }

  Result<std::monostate> read_section(const TableEntry& entry, const char* name,
                                      std::span<std::byte> bytes) {
    if (!bytes.empty()) {
      if (auto done = read_at_(entry.offset, bytes); !done) return done;
    }
    const std::size_t whole = bytes.size() / kAlignment * kAlignment;
    checksum_.add(bytes.first(whole));
    if (whole == bytes.size()) return std::monostate{};
    std::array<std::byte, kAlignment> end{};
    if (auto done = read_at_(entry.offset + whole, end); !done) return done;
    checksum_.add(end);
    if (is_zero(std::span(end).subspan(bytes.size() - whole))) return std::monostate{};
    return invalid("there are bits set between its %s and what follows", name);
  }

  std::uint64_t size_;
  const ReadAt& read_at_;
  Header header_{};
  std::array<TableEntry, kSectionCount> table_{};
  Checksum checksum_;
};

/// A part that a model refuses is an error of the file.
Error in_file(const char* part, const Error& error) {
  return invalid("its %s cannot be used: %s", part, error.message.c_str());
}

bool is_method(std::int64_t value) {
  return value >= static_cast<std::int64_t>(SignMethod::kAutomatic) &&
         value <= static_cast<std::int64_t>(SignMethod::kWinding);
}

Result<GridField> make_field(const Record& record, Sections<Array>& sections) {
  GridFieldData data{
      .voxel_size = record.grid_voxel_size,
      .origin = record.grid_origin,
      .bricks = {},
      .surface_bounds = {record.grid_surface_lower, record.grid_surface_upper},
      .entries = std::move(sections.brick_entries),
      .samples = std::move(sections.samples),
      .quanta_per_voxel = static_cast<int>(
          std::min<std::uint64_t>(record.grid_quanta_per_voxel, std::numeric_limits<int>::max())),
      .planes = std::move(sections.planes),
      .node_error = record.grid_node_error,
      .surface_error = record.grid_surface_error,
      .coarse_floors = record.grid_coarse_floors,
      .sign = {.method = static_cast<SignMethod>(record.sign_method),
               .confidence = record.sign_confidence,
               .was_turned = record.sign_was_turned != 0,
               .defects = {.open_edges = record.sign_defects[0],
                           .non_manifold_edges = record.sign_defects[1],
                           .flipped_edges = record.sign_defects[2],
                           .first_location = record.sign_first_defect},
               .overlaps = record.sign_overlaps,
               .hidden_triangles = record.sign_hidden_triangles,
               .first_location = record.sign_first_location,
               .cap_error = record.sign_cap_error},
      .exact = {.bricks = std::move(sections.exact_bricks),
                .masks = std::move(sections.exact_masks),
                .lists = std::move(sections.exact_lists),
                .listed = std::move(sections.listed_triangles),
                .triangles = std::move(sections.exact_triangles),
                .feature_normals = std::move(sections.feature_normals)},
  };
  if (!is_method(record.sign_method) || record.sign_was_turned > 1) {
    return invalid("its field cannot be used: its signs were found in no known way");
  }
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const std::int64_t bricks = record.grid_bricks[axis];
    if (bricks < 1 || bricks > std::numeric_limits<int>::max()) {
      return invalid("its field cannot be used: it is %lld bricks wide",
                     static_cast<long long>(bricks));
    }
    data.bricks[axis] = static_cast<int>(bricks);
  }
  if (auto checked = check_grid_field(data); !checked) return in_file("field", checked.error());
  return GridField(std::move(data));
}

/// None where the model was written without.
Result<std::optional<EdgeSegments>> make_edges(const Record& record, Sections<Array>& sections) {
  if (sections.edge_middles.empty() && sections.edge_halves.empty() &&
      sections.edge_normals.empty() && sections.edge_spheres.empty() &&
      sections.edge_blocks.empty() && record.edge_tolerance == 0.0) {
    return std::optional<EdgeSegments>{};
  }
  auto tree = PointSphereTree::from_parts(sections.edge_middles, std::move(sections.edge_spheres),
                                          std::move(sections.edge_blocks));
  if (!tree) return in_file("tree of edges", tree.error());
  auto edges = EdgeSegments::from_parts({.tree = *std::move(tree),
                                         .halves = std::move(sections.edge_halves),
                                         .normals = std::move(sections.edge_normals),
                                         .tolerance = record.edge_tolerance});
  if (!edges) return in_file("edges", edges.error());
  return std::optional<EdgeSegments>(*std::move(edges));
}

Result<PointShell> make_shell(const Record& record, Sections<Array>& sections) {
  auto tree = PointSphereTree::from_parts(sections.points, std::move(sections.spheres),
                                          std::move(sections.blocks));
  if (!tree) return in_file("tree", tree.error());
  auto edges = make_edges(record, sections);
  if (!edges) return edges.error();
  auto shell = PointShell::from_parts({.tree = *std::move(tree),
                                       .normals = std::move(sections.normals),
                                       .areas = std::move(sections.areas),
                                       .spacing = record.shell_spacing,
                                       .edges = *std::move(edges)});
  if (!shell) return in_file("shell", shell.error());
  return shell;
}

Result<ModelSettings> make_settings(const Record& record) {
  if (record.resolution < 0 || record.resolution > std::numeric_limits<int>::max()) {
    return invalid("its settings cannot be used: the resolution is %lld",
                   static_cast<long long>(record.resolution));
  }
  for (const double value : {record.tolerance, record.voxel_size, record.point_spacing,
                             record.padding, record.sheet_thickness}) {
    if (!std::isfinite(value)) return invalid("its settings cannot be used: one is %g", value);
  }
  if (!is_method(record.sign)) {
    return invalid("its settings cannot be used: the sign is %lld",
                   static_cast<long long>(record.sign));
  }
  if (record.open < 0 || record.open > static_cast<std::int64_t>(OpenMesh::kSheet)) {
    return invalid("its settings cannot be used: what open meshes become is %lld",
                   static_cast<long long>(record.open));
  }
  return ModelSettings{.tolerance = record.tolerance,
                       .voxel_size = record.voxel_size,
                       .resolution = static_cast<int>(record.resolution),
                       .point_spacing = record.point_spacing,
                       .target_points = record.target_points,
                       .padding = record.padding,
                       .sign = static_cast<SignMethod>(record.sign),
                       .open = static_cast<OpenMesh>(record.open),
                       .sheet_thickness = record.sheet_thickness};
}

Result<Accuracy> make_accuracy(const Record& record) {
  const auto is_error = [](double value) { return std::isfinite(value) && value >= 0.0; };
  const auto& errors = record.accuracy_errors;
  if (!std::ranges::all_of(errors, is_error) || !is_error(record.accuracy_gap) ||
      !is_error(record.accuracy_curvature) || !is_error(record.thickness) ||
      record.accuracy_is_sharp > 1) {
    return invalid("its accuracy cannot be used: a number is negative or not finite");
  }
  return Accuracy{.places = static_cast<std::size_t>(record.accuracy_places),
                  .distance = {errors[0], errors[1], errors[2]},
                  .normal = {errors[3], errors[4], errors[5]},
                  .coverage = {errors[6], errors[7], errors[8]},
                  .gap = record.accuracy_gap,
                  .is_sharp = record.accuracy_is_sharp != 0,
                  .curvature = record.accuracy_curvature};
}

Result<Openings> make_openings(const Record& record) {
  for (const double value : {record.openings_fraction, record.openings_largest_diameter,
                             record.openings_sheet_thickness}) {
    if (!std::isfinite(value) || value < 0.0) {
      return invalid("its openings cannot be used: one number is %g", value);
    }
  }
  if (!is_finite(record.openings_first_location)) {
    return invalid("its openings cannot be used: their location is not finite");
  }
  return Openings{.loops = static_cast<std::size_t>(record.openings_loops),
                  .fraction = record.openings_fraction,
                  .mouths = static_cast<std::size_t>(record.openings_mouths),
                  .largest_diameter = record.openings_largest_diameter,
                  .first_location = record.openings_first_location,
                  .sheet_thickness = record.openings_sheet_thickness};
}

Result<std::shared_ptr<const Model>> make_model(Sections<Array> sections) {
  if (sections.record.size() != 1) {
    return invalid("it has %zu records instead of one", sections.record.size());
  }
  const Record record = sections.record.front();
  const auto settings = make_settings(record);
  if (!settings) return settings.error();
  auto mesh = TriangleMesh::from_parts(std::move(sections.vertices), std::move(sections.triangles));
  if (!mesh) return in_file("mesh", mesh.error());
  auto field = make_field(record, sections);
  if (!field) return field.error();
  auto shell = make_shell(record, sections);
  if (!shell) return shell.error();
  const auto accuracy = make_accuracy(record);
  if (!accuracy) return accuracy.error();
  const auto openings = make_openings(record);
  if (!openings) return openings.error();
  auto model = Model::from_parts(*std::move(mesh), *std::move(field), *std::move(shell), *settings,
                                 *accuracy, record.thickness, *openings);
  if (!model) return in_file("parts", model.error());
  return model;
}

}  // namespace

Result<std::shared_ptr<const Model>> read_model(std::uint64_t size, std::uint64_t memory_limit,
                                                const ReadAt& read_at) {
  if (size > memory_limit) {
    return Error{ErrorCode::kTooLarge, format_text("its %llu bytes are above the limit of %llu",
                                                   number(size), number(memory_limit))};
  }
  try {
    auto sections = Reader(size, read_at).read();
    if (!sections) return sections.error();
    return make_model(*std::move(sections));
  } catch (const std::bad_alloc&) {
    return Error{ErrorCode::kTooLarge,
                 format_text("there is not enough memory for its %llu bytes", number(size))};
  }
}

}  // namespace voxshell
