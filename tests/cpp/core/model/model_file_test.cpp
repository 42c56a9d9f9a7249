#include "voxshell/model_file.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <fstream>
#include <functional>
#include <iterator>
#include <limits>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "support/meshes.h"
#include "support/model_bytes.h"
#include "support/random.h"
#include "support/temporary_folder.h"
#include "voxshell/contacts.h"

namespace voxshell::model_file_test {
namespace {

using namespace test_support;
using model_format::Header;
using model_format::Record;
using model_format::TableEntry;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

std::shared_ptr<const Model> build(const Soup& soup, const ModelSettings& settings) {
  auto model = Model::build(soup.mesh(), settings);
  if (!model) std::abort();
  return *std::move(model);
}

/// Small, with a few thousand bytes in each section.
const Model& small_model() {
  static const auto* model = new std::shared_ptr<const Model>(
      build(make_l_shape(0.1), {.voxel_size = 0.05, .target_points = 100, .padding = 0.0}));
  return **model;
}

const FileBytes& small_file() {
  static const auto* bytes = new FileBytes(to_bytes(small_model()));
  return *bytes;
}

/// The field of the small model with a shell that has edges.
const Model& edgy_model() {
  static const auto* model = [] {
    auto shell = PointShell::build(make_l_shape(0.1).mesh(), {.tolerance = 3e-3});
    if (!shell) std::abort();
    auto made = Model::from_parts(small_model().mesh(), small_model().grid(), *std::move(shell),
                                  {.tolerance = 3e-3}, small_model().accuracy(),
                                  small_model().thickness(), {});
    if (!made) std::abort();
    return new std::shared_ptr<const Model>(*std::move(made));
  }();
  return **model;
}

const FileBytes& edgy_file() {
  static const auto* bytes = new FileBytes(to_bytes(edgy_model()));
  return *bytes;
}

enum Kind : std::uint32_t {
  kRecord = 1,
  kVertices,
  kTriangles,
  kEntries,
  kSamples,
  kPlanes,
  kPoints,
  kNormals,
  kAreas,
  kSpheres,
  kBlocks,
  kExactBricks,
  kExactMasks,
  kExactLists,
  kListedTriangles,
  kExactTriangles,
  kFeatureNormals,
  kEdgeMiddles,
  kEdgeHalves,
  kEdgeNormals,
  kEdgeSpheres,
  kEdgeBlocks,
};

/// Offset in a file of item `index` of a section.
std::size_t item(const FileBytes& bytes, Kind kind, std::size_t index) {
  const TableEntry entry = table_entry(bytes, kind);
  return entry.offset + index * entry.item_size;
}

template <class T>
void expect_equal(std::span<const T> a, std::span<const T> b) {
  ASSERT_EQ(a.size(), b.size());
  EXPECT_TRUE(a.empty() || std::memcmp(a.data(), b.data(), a.size_bytes()) == 0);
}

void expect_equal(const EdgeSegments* a, const EdgeSegments* b) {
  ASSERT_EQ(a == nullptr, b == nullptr);
  if (a == nullptr) return;
  EXPECT_EQ(std::vector<Vec3f>(a->middles().begin(), a->middles().end()),
            std::vector<Vec3f>(b->middles().begin(), b->middles().end()));
  expect_equal(a->halves(), b->halves());
  expect_equal(a->normals(), b->normals());
  expect_equal(a->tree().spheres(), b->tree().spheres());
  expect_equal(a->tree().blocks(), b->tree().blocks());
  EXPECT_EQ(a->tolerance(), b->tolerance());
  EXPECT_EQ(a->reach(), b->reach());
}

std::vector<Vec3f> points_of(const Model& model) {
  const BucketPoints points = model.shell().points();
  return {points.begin(), points.end()};
}

void expect_equal(const Model& a, const Model& b) {
  expect_equal(a.mesh().vertices(), b.mesh().vertices());
  expect_equal(a.mesh().triangles(), b.mesh().triangles());
  const GridFieldData& f = a.grid().data();
  const GridFieldData& g = b.grid().data();
  expect_equal<std::uint32_t>(f.entries, g.entries);
  expect_equal<std::int16_t>(f.samples, g.samples);
  expect_equal<float>(f.planes, g.planes);
  EXPECT_EQ(f.voxel_size, g.voxel_size);
  EXPECT_EQ(f.origin, g.origin);
  EXPECT_EQ(f.bricks, g.bricks);
  EXPECT_EQ(f.surface_bounds.lower, g.surface_bounds.lower);
  EXPECT_EQ(f.surface_bounds.upper, g.surface_bounds.upper);
  EXPECT_EQ(f.node_error, g.node_error);
  EXPECT_EQ(f.coarse_floors, g.coarse_floors);
  EXPECT_EQ(points_of(a), points_of(b));
  expect_equal(a.shell().normals(), b.shell().normals());
  expect_equal(a.shell().areas(), b.shell().areas());
  EXPECT_EQ(a.shell().spacing(), b.shell().spacing());
  expect_equal(a.shell().edges(), b.shell().edges());
  EXPECT_EQ(a.shell().tree().level_count(), b.shell().tree().level_count());
  expect_equal(a.shell().tree().spheres(), b.shell().tree().spheres());
  expect_equal(a.shell().tree().blocks(), b.shell().tree().blocks());
  EXPECT_EQ(a.bounds().lower, b.bounds().lower);
  EXPECT_EQ(a.bounds().upper, b.bounds().upper);
  EXPECT_EQ(a.solid_mass_properties().center_of_mass, b.solid_mass_properties().center_of_mass);
  EXPECT_EQ(a.surface_mass_properties().inertia.row_x, b.surface_mass_properties().inertia.row_x);
  EXPECT_EQ(a.settings().tolerance, b.settings().tolerance);
  EXPECT_EQ(a.settings().voxel_size, b.settings().voxel_size);
  EXPECT_EQ(a.settings().resolution, b.settings().resolution);
  EXPECT_EQ(a.settings().point_spacing, b.settings().point_spacing);
  EXPECT_EQ(a.settings().target_points, b.settings().target_points);
  EXPECT_EQ(a.settings().padding, b.settings().padding);
}

class ModelFile : public testing::Test {
 protected:
  std::string path(const std::string& name) const { return (folder_.path() / name).string(); }

  TemporaryFolder folder_;
};

TEST_F(ModelFile, HoldsTheWholeModel) {
  for (const auto& model :
       {build(make_blob(0.3, 3), {.resolution = 20, .target_points = 2000}),
        build(make_torus(0.4, 0.1, 30, 15), {.resolution = 25, .point_spacing = 0.05}),
        build(make_l_shape(0.1), {.tolerance = 1e-3}),
        build(make_corner_tetrahedron(1e-3), {.voxel_size = 1e-4})}) {
    ASSERT_TRUE(save_model(*model, path("model")));
    const auto loaded = load_model(path("model"));
    ASSERT_TRUE(loaded) << loaded.error().message;
    expect_equal(*model, **loaded);
  }
}

TEST_F(ModelFile, GivesAModelThatCollidesAsTheFirstDid) {
  const auto model = build(make_blob(0.3, 3), {.resolution = 30});
  ASSERT_TRUE(save_model(*model, path("blob")));
  const auto loaded = load_model(path("blob"));
  ASSERT_TRUE(loaded);
  Random random(3);
  QueryScratch scratch;
  std::size_t found = 0;
  for (int i = 0; i < 50; ++i) {
    const Pose pose = random.pose(0.3);
    const auto expected = find_contacts(model->field(), model->shell(), pose, {}, scratch);
    const std::vector<Contact> before(expected.begin(), expected.end());
    const auto after = find_contacts((*loaded)->field(), (*loaded)->shell(), pose, {}, scratch);
    ASSERT_TRUE(std::equal(before.begin(), before.end(), after.begin(), after.end()));
    found += before.size();
  }
  EXPECT_GT(found, 1000u);
}

TEST_F(ModelFile, IsTheSameForTheSameModel) {
  const Soup soup = make_l_shape(0.1);
  const ModelSettings settings{.voxel_size = 0.02};
  EXPECT_EQ(to_bytes(*build(soup, settings)), to_bytes(*build(soup, settings)));
  const auto loaded = from_bytes(small_file());
  ASSERT_TRUE(loaded);
  EXPECT_EQ(to_bytes(**loaded), small_file());
}

TEST_F(ModelFile, ReplacesTheOneBefore) {
  const auto first = build(make_box({0.1, 0.1, 0.1}), {.voxel_size = 0.05});
  ASSERT_TRUE(save_model(*first, path("model")));
  ASSERT_TRUE(save_model(small_model(), path("model")));
  const auto loaded = load_model(path("model"));
  ASSERT_TRUE(loaded);
  expect_equal(small_model(), **loaded);
}

TEST_F(ModelFile, IsReadFromItsBytesInMemory) {
  ASSERT_TRUE(save_model(small_model(), path("a")));
  std::ifstream file(path("a"), std::ios::binary);
  const std::string saved{std::istreambuf_iterator<char>(file), {}};
  const std::vector<std::byte> bytes = model_to_bytes(small_model());
  expect_equal(std::as_bytes(std::span(saved)), std::span<const std::byte>(bytes));
  const auto model = model_from_bytes(bytes);
  ASSERT_TRUE(model) << model.error().message;
  EXPECT_EQ(model_to_bytes(**model), bytes);
  const auto half = model_from_bytes(std::span(bytes).first(bytes.size() / 2));
  ASSERT_FALSE(half);
  EXPECT_EQ(half.error().code, ErrorCode::kInvalidFile);
}

TEST_F(ModelFile, NamesThePathInErrors) {
  const auto missing = load_model(path("missing"));
  ASSERT_FALSE(missing);
  EXPECT_EQ(missing.error().code, ErrorCode::kFileAccess);
  EXPECT_NE(missing.error().message.find(path("missing")), std::string::npos);
  std::ofstream(path("text")) << std::string(1000, 'x');
  const auto text = load_model(path("text"));
  ASSERT_FALSE(text);
  EXPECT_EQ(text.error().code, ErrorCode::kInvalidFile);
  EXPECT_EQ(text.error().message.find(path("text")), 0u) << text.error().message;
  const auto nowhere = save_model(small_model(), path("no/such/folder"));
  ASSERT_FALSE(nowhere);
  EXPECT_EQ(nowhere.error().code, ErrorCode::kFileAccess);
}

// ---- what readers must refuse -------------------------------------------------------------------

void expect_refused(const FileBytes& bytes, const std::string& reason) {
  const auto model = from_bytes(bytes);
  ASSERT_FALSE(model) << "accepted, but expected: " << reason;
  EXPECT_EQ(model.error().code, ErrorCode::kInvalidFile) << model.error().message;
  EXPECT_NE(model.error().message.find(reason), std::string::npos)
      << model.error().message << "\nexpected: " << reason;
}

TEST(ModelBytes, ThatEndEarlyOrLateAreRefused) {
  const FileBytes& whole = small_file();
  ASSERT_TRUE(from_bytes(whole));
  std::vector<std::size_t> sizes{0, 1, 7, 8, 31, 32, 63, 64, 65, whole.size() - 1};
  for (std::uint32_t kind = kRecord; kind <= kBlocks; ++kind) {
    const TableEntry entry = table_entry(whole, kind);
    for (const std::size_t end : {entry.offset, entry.offset + entry.count * entry.item_size}) {
      sizes.insert(sizes.end(), {end - 1, end, end + 1});
    }
  }
  for (std::size_t size = 0; size < whole.size(); size += 977) sizes.push_back(size);
  for (const std::size_t size : sizes) {
    if (size >= whole.size()) continue;
    FileBytes cut(whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(size));
    expect_refused(cut, size < 64 ? "not a model file: it has" : "but was written with");
    if (size < 64) continue;
    // The same, pretending that it was meant so.
    write_at(cut, offsetof(Header, file_size), std::uint64_t{size});
    fix_checksum(cut);
    expect_refused(cut, "it");
  }
  FileBytes longer = whole;
  longer.push_back(std::byte{0});
  expect_refused(longer, "but was written with");
  write_at(longer, offsetof(Header, file_size), std::uint64_t{longer.size()});
  fix_checksum(longer);
  expect_refused(longer, "its sections end at byte");
}

TEST(ModelBytes, OfAnyBitChangedAreRefused) {
  FileBytes bytes = small_file();
  Random random(4);
  for (std::size_t i = 0; i < bytes.size() + 2000; ++i) {
    // All of the header and the table, and some of the rest.
    const std::size_t at = i < 8 * model_format::kTableEnd ? i / 8 : random.below(bytes.size());
    const auto mask = std::byte{1} << static_cast<int>(i % 8);
    bytes[at] ^= mask;
    EXPECT_FALSE(from_bytes(bytes)) << "byte " << at;
    bytes[at] ^= mask;
  }
  EXPECT_TRUE(from_bytes(bytes));
}

TEST(ModelBytes, WithAWrongHeaderAreRefused) {
  const auto with = [](std::size_t offset, auto value) {
    FileBytes bytes = small_file();
    write_at(bytes, offset, value);
    fix_checksum(bytes);
    return bytes;
  };
  expect_refused(with(0, 'V'), "does not begin with the signature");
  expect_refused(with(4, '\n'), "does not begin with the signature");
  for (const std::uint32_t version :
       {0u, 1u, model_format::kVersion - 1, model_format::kVersion + 1, 0xffffffffu}) {
    expect_refused(with(offsetof(Header, version), version), "version " + std::to_string(version));
  }
  for (const std::uint32_t count :
       {0u, model_format::kSectionCount - 1, model_format::kSectionCount + 1, 0xffffffffu}) {
    expect_refused(with(offsetof(Header, section_count), count), "sections");
  }
  for (const std::uint64_t size : {std::uint64_t{0}, std::uint64_t{64}, ~std::uint64_t{0}}) {
    expect_refused(with(offsetof(Header, file_size), size), "but was written with");
  }
  expect_refused(with(offsetof(Header, zeros), 1), "its header has bits set");
  expect_refused(with(offsetof(Header, more_zeros), 1), "its header has bits set");
  FileBytes unsummed = small_file();
  write_at(unsummed, offsetof(Header, checksum), std::uint64_t{1});
  expect_refused(unsummed, "it is damaged: the checksum is");
}

TEST(ModelBytes, WithAWrongTableAreRefused) {
  for (std::uint32_t kind = kRecord; kind <= kBlocks; ++kind) {
    const TableEntry right = table_entry(small_file(), kind);
    const auto with = [&](const TableEntry& entry) {
      FileBytes bytes = small_file();
      write_at(bytes, table_offset(kind), entry);
      fix_checksum(bytes);
      return bytes;
    };
    const auto changed = [&](auto TableEntry::* member, auto value) {
      TableEntry entry = right;
      entry.*member = static_cast<std::remove_reference_t<decltype(entry.*member)>>(value);
      return with(entry);
    };
    expect_refused(changed(&TableEntry::kind, 99), "its table says kind 99");
    expect_refused(changed(&TableEntry::kind, kind % kBlocks + 1), "its table says kind");
    expect_refused(changed(&TableEntry::item_size, right.item_size + 1), "item size");
    expect_refused(changed(&TableEntry::item_size, 0), "item size 0");
    for (const std::uint64_t offset :
         {std::uint64_t{0}, right.offset - 64, right.offset + 1, right.offset + 64,
          std::uint64_t{small_file().size()}, ~std::uint64_t{0} - 63}) {
      expect_refused(changed(&TableEntry::offset, offset), "and offset " + std::to_string(offset));
    }
    // The products of some overflow 64 bits.
    for (const std::uint64_t count :
         {right.count + 1000, std::uint64_t{1} << 32, std::uint64_t{1} << 60,
          std::uint64_t{1} << 62, ~std::uint64_t{0}}) {
      expect_refused(changed(&TableEntry::count, count), "its");
    }
    if (right.count > 0) expect_refused(changed(&TableEntry::count, 0), "");
    expect_refused(changed(&TableEntry::zero, 1), "its table says");
  }
}

TEST(ModelBytes, WithBitsBetweenSectionsAreRefused) {
  int gaps = 0;
  for (std::uint32_t kind = kRecord; kind <= kBlocks; ++kind) {
    const TableEntry entry = table_entry(small_file(), kind);
    const std::size_t end = entry.offset + entry.count * entry.item_size;
    if (end % 64 == 0) continue;
    FileBytes bytes = small_file();
    bytes[end] = std::byte{1};
    fix_checksum(bytes);
    expect_refused(bytes, "there are bits set between its");
    ++gaps;
  }
  EXPECT_GT(gaps, 4);
}

TEST(ModelBytes, WithNumbersThatCannotBeAreRefused) {
  const auto with = [](Kind kind, std::size_t index, std::size_t offset, auto value) {
    FileBytes bytes = small_file();
    write_at(bytes, item(bytes, kind, index) + offset, value);
    fix_checksum(bytes);
    return bytes;
  };
  const auto in_record = [&](std::size_t offset, auto value) {
    return with(kRecord, 0, offset, value);
  };
  const float nanf = std::numeric_limits<float>::quiet_NaN();
  const float infinityf = std::numeric_limits<float>::infinity();

  expect_refused(in_record(offsetof(Record, resolution), std::int64_t{-1}), "resolution is -1");
  expect_refused(in_record(offsetof(Record, voxel_size), kNan), "its settings cannot be used");
  expect_refused(in_record(offsetof(Record, padding), kInfinity), "its settings cannot be used");
  expect_refused(in_record(offsetof(Record, open), std::int64_t{3}),
                 "what open meshes become is 3");
  expect_refused(in_record(offsetof(Record, sheet_thickness), kNan), "its settings cannot be used");
  expect_refused(in_record(offsetof(Record, openings_fraction), -1.0),
                 "its openings cannot be used");
  expect_refused(in_record(offsetof(Record, openings_first_location), kNan), "location");
  expect_refused(in_record(offsetof(Record, thickness), kNan), "its accuracy cannot be used");
  expect_refused(in_record(offsetof(Record, accuracy_gap), -1.0), "its accuracy cannot be used");
  for (const double size : {kNan, kInfinity, 0.0, -1.0, 1e300, 1e-300}) {
    expect_refused(in_record(offsetof(Record, grid_voxel_size), size), "the voxel size is");
  }
  for (const double value : {kNan, kInfinity, -1.0}) {
    expect_refused(in_record(offsetof(Record, grid_node_error), value), "its error is");
    expect_refused(in_record(offsetof(Record, grid_coarse_floors) + 8, value), "its floors are");
    expect_refused(in_record(offsetof(Record, shell_spacing), value), "the spacing is");
  }
  expect_refused(in_record(offsetof(Record, grid_coarse_floors), 1e6), "in the wrong order");
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const std::size_t at = 8 * axis;
    for (const std::int64_t bricks :
         {std::int64_t{0}, std::int64_t{-1}, std::int64_t{1000}, std::int64_t{1} << 31,
          std::numeric_limits<std::int64_t>::max()}) {
      expect_refused(in_record(offsetof(Record, grid_bricks) + at, bricks), "its field");
    }
    expect_refused(in_record(offsetof(Record, grid_origin) + at, kNan), "its origin or bounds");
    expect_refused(in_record(offsetof(Record, grid_surface_lower) + at, kNan), "bounds");
    expect_refused(in_record(offsetof(Record, grid_surface_upper) + at, -1.0), "bounds");
    expect_refused(in_record(offsetof(Record, grid_surface_lower) + at, -7.0), "other bounds");
    for (const double place : {kNan, kInfinity, 1e300}) {
      expect_refused(with(kVertices, 1, at, place), "its mesh cannot be used");
    }
    for (const float place : {nanf, infinityf, -3e38f}) {
      expect_refused(with(kPoints, 5, 4 * axis, place), "cannot be used");
      expect_refused(with(kNormals, 5, 4 * axis, place), "the normal of point 5");
      expect_refused(with(kSpheres, 1, 4 * axis, place), "cluster 0 on level 2");
    }
  }
  const auto vertex_count = static_cast<std::uint32_t>(small_model().mesh().vertices().size());
  for (const std::uint32_t index : {vertex_count, 0x7fffffffu, 0xffffffffu}) {
    expect_refused(with(kTriangles, 3, 4, index), "triangle 3 of the mesh uses vertex");
  }
  expect_refused(with(kTriangles, 3, 0, small_model().mesh().triangles()[3][1]),
                 "less than three corners");
  for (const float area : {nanf, infinityf, -1.0f}) {
    expect_refused(with(kAreas, 7, 0, area), "the area of point 7");
  }
  for (const float radius : {nanf, infinityf, -1.0f, 0.0f}) {
    expect_refused(with(kSpheres, 0, 12, radius), "cluster 0 on level 1");
    expect_refused(with(kBlocks, 24, 0, radius), "sphere 0 on level 0 of the walk");
  }
  expect_refused(with(kPoints, 0, 0, 100.0f), "cannot be used");
}

TEST(ModelBytes, WithEdgesThatCannotBeAreRefused) {
  const auto with = [](Kind kind, std::size_t index, std::size_t offset, auto value) {
    FileBytes bytes = edgy_file();
    write_at(bytes, item(bytes, kind, index) + offset, value);
    fix_checksum(bytes);
    return bytes;
  };
  ASSERT_TRUE(from_bytes(edgy_file()));
  ASSERT_GT(edgy_model().shell().edges()->size(), 20u);
  const float nanf = std::numeric_limits<float>::quiet_NaN();
  const float infinityf = std::numeric_limits<float>::infinity();
  for (std::size_t axis = 0; axis < 3; ++axis) {
    for (const float place : {nanf, infinityf, -3e38f}) {
      expect_refused(with(kEdgeMiddles, 5, 4 * axis, place), "cannot be used");
      expect_refused(with(kEdgeHalves, 5, 4 * axis, place), "edge segment 5 is not finite");
      expect_refused(with(kEdgeNormals, 5, 4 * axis, place), "the normal of edge segment 5");
      expect_refused(with(kEdgeSpheres, 1, 4 * axis, place), "cluster 0 on level 2");
    }
    expect_refused(with(kEdgeHalves, 5, 4 * axis, 1.0f), "lie outside the mesh's bounds");
  }
  for (const float radius : {nanf, infinityf, -1.0f, 0.0f}) {
    expect_refused(with(kEdgeSpheres, 0, 12, radius), "its tree of edges");
    expect_refused(with(kEdgeBlocks, 24, 0, radius), "its tree of edges");
  }
  for (const double tolerance : {kNan, kInfinity, -1.0, 0.0}) {
    expect_refused(with(kRecord, 0, offsetof(Record, edge_tolerance), tolerance),
                   "tolerance of edge segments");
  }
  FileBytes none = small_file();
  write_at(none, item(none, kRecord, 0) + offsetof(Record, edge_tolerance), 1.0);
  fix_checksum(none);
  expect_refused(none, "its tree of edges");
}

TEST(ModelBytes, WithEntriesBeyondTheArraysAreRefused) {
  const auto with = [](std::uint32_t entry) {
    FileBytes bytes = small_file();
    write_at(bytes, item(bytes, kEntries, 2), entry);
    fix_checksum(bytes);
    return bytes;
  };
  const GridFieldData& grid = small_model().grid().data();
  const std::size_t samples = grid.samples.size();
  for (std::uint32_t level = 0; level < 4; ++level) {
    const std::size_t nodes = (std::size_t{1} << level) + 1;
    const auto in_row = static_cast<std::size_t>(grid.bricks[0] + 1);
    const auto in_layer = in_row * static_cast<std::size_t>(grid.bricks[1] + 1);
    const std::size_t last =
        level == 0 ? samples - in_layer - in_row - 2 : (samples - nodes * nodes * nodes) / 4;
    EXPECT_TRUE(from_bytes(with(static_cast<std::uint32_t>(last << 7) | level)));
    expect_refused(with(static_cast<std::uint32_t>((last + 1) << 7) | level), "brick 2 holds");
    expect_refused(with(0xffffff80u | level), "brick 2 holds samples");
  }
  ASSERT_TRUE(small_model().grid().data().planes.empty());
  expect_refused(with(4u), "brick 2 holds plane 0");
}

TEST(ModelBytes, WithPlanesThatAreNoneAreRefused) {
  const auto box = build(make_box({0.5, 0.5, 0.5}), {.resolution = 60, .target_points = 100});
  const GridFieldData& data = box->grid().data();
  const auto planes = static_cast<std::uint32_t>(data.planes.size() / 4);
  ASSERT_GT(planes, 0u);
  const FileBytes whole = to_bytes(*box);
  const auto loaded = from_bytes(whole);
  ASSERT_TRUE(loaded);
  expect_equal(*box, **loaded);
  const auto with = [&](Kind kind, std::size_t index, auto value) {
    FileBytes bytes = whole;
    write_at(bytes, item(bytes, kind, index), value);
    fix_checksum(bytes);
    return bytes;
  };
  for (const float value : {std::numeric_limits<float>::quiet_NaN(), 2.0f, -3e38f}) {
    for (std::size_t i = 0; i < 4; ++i) {
      if (i == 3 && value == 2.0f) continue;  // an offset
      expect_refused(with(kPlanes, i, value),
                     "plane 0: normal is not of unit length, or offset is too large");
    }
  }
  EXPECT_TRUE(from_bytes(with(kEntries, 0, (planes - 1) << 7 | 4u)));
  expect_refused(with(kEntries, 0, planes << 7 | 4u), "brick 0 holds plane");
}

TEST(ModelBytes, OfCountsThatDisagreeAreRefused) {
  // Each section loses its last items; what follows moves up.
  const model_format::TableEntry last = table_entry(edgy_file(), kEdgeBlocks);
  for (std::uint32_t kind = kRecord; kind <= kEdgeBlocks; ++kind) {
    const TableEntry entry = table_entry(edgy_file(), kind);
    if (entry.count == 0) continue;
    if (kind == kTriangles) continue;  // one less is another mesh, which may be open
    const std::uint64_t keep = kind == kSamples ? 1000 : entry.count - 1;
    const std::size_t old_end = entry.offset + model_format::align(entry.count * entry.item_size);
    const std::size_t new_size = keep * entry.item_size;
    FileBytes bytes(edgy_file().begin(),
                    edgy_file().begin() + static_cast<std::ptrdiff_t>(entry.offset + new_size));
    bytes.resize(entry.offset + model_format::align(new_size));
    const std::uint64_t lost = old_end - bytes.size();
    bytes.insert(bytes.end(), edgy_file().begin() + static_cast<std::ptrdiff_t>(old_end),
                 edgy_file().end());
    TableEntry shorter = entry;
    shorter.count = keep;
    write_at(bytes, table_offset(kind), shorter);
    for (std::uint32_t later = kind + 1; later <= last.kind; ++later) {
      TableEntry moved = table_entry(bytes, later);
      moved.offset -= lost;
      write_at(bytes, table_offset(later), moved);
    }
    write_at(bytes, offsetof(Header, file_size), std::uint64_t{bytes.size()});
    fix_checksum(bytes);
    expect_refused(bytes, kind == kRecord ? "0 records" : "cannot be used");
  }
}

TEST(ModelBytes, BeyondTheMemoryLimitAreRefused) {
  const auto model = from_bytes(small_file(), small_file().size() - 1);
  ASSERT_FALSE(model);
  EXPECT_EQ(model.error().code, ErrorCode::kTooLarge);
  EXPECT_TRUE(from_bytes(small_file(), small_file().size()));
}

TEST(ModelBytes, ChangedAtRandomAreRefusedOrGiveASoundModel) {
  // Under the sanitizers this finds what validation lets through.
  Random random(5);
  QueryScratch scratch;
  int accepted = 0;
  int refused = 0;
  for (int round = 0; round < 4000; ++round) {
    const FileBytes& whole = round % 2 == 0 ? small_file() : edgy_file();
    FileBytes bytes = whole;
    // Sections are of very different sizes: one of them first, then a place in it.
    for (std::size_t change = 0; change <= random.below(3); ++change) {
      const TableEntry entry =
          table_entry(whole, static_cast<std::uint32_t>(1 + random.below(kEdgeBlocks)));
      const std::size_t size = entry.count * entry.item_size;
      if (size == 0) continue;
      const std::size_t at = entry.offset + random.below(size);
      bytes[at] = random.below(2) == 0 ? bytes[at] ^ (std::byte{1} << random.below(8))
                                       : static_cast<std::byte>(random.below(256));
    }
    fix_checksum(bytes);
    const auto model = from_bytes(bytes);
    if (!model) {
      EXPECT_EQ(model.error().code, ErrorCode::kInvalidFile) << model.error().message;
      ++refused;
      continue;
    }
    ++accepted;
    const Pose pose = random.pose(0.2);
    find_contacts((*model)->field(), small_model().shell(), pose, {.margin = 0.1f}, scratch);
    find_contacts(small_model().field(), (*model)->shell(), pose, {.margin = 0.1f}, scratch);
    collides(small_model().field(), (*model)->shell(), pose);
  }
  EXPECT_GT(accepted, 500);
  EXPECT_GT(refused, 500);
}

}  // namespace
}  // namespace voxshell::model_file_test
