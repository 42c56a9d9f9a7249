// Not a test: `./dev processors` runs it. Writes model files on one processor, and compares them on
// another with the models that are built there.

#include <cstdio>
#include <fstream>
#include <iterator>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "support/model_bytes.h"
#include "support/random.h"
#include "support/traveling_models.h"
#include "voxshell/contacts.h"
#include "voxshell/model_file.h"

namespace {

using namespace voxshell;
using namespace voxshell::test_support;

FileBytes read_file(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  const std::vector<char> chars{std::istreambuf_iterator<char>(file), {}};
  const auto bytes = std::as_bytes(std::span(chars));
  return {bytes.begin(), bytes.end()};
}

std::vector<Contact> collide(const Model& model) {
  Random random(7);
  QueryScratch scratch;
  std::vector<Contact> all;
  for (int i = 0; i < 20; ++i) {
    const Pose pose{make_rotation(random), random.in_cube(0.2)};
    const auto found = find_contacts(model.field(), model.shell(), pose, {}, scratch);
    all.insert(all.end(), found.begin(), found.end());
  }
  return all;
}

bool write_file(const std::string& path, const Model& model) {
  const auto saved = save_model(model, path);
  if (!saved) std::fprintf(stderr, "%s\n", saved.error().message.c_str());
  return saved.has_value();
}

bool check_file(const std::string& path, const Model& model) {
  const auto loaded = load_model(path);
  if (!loaded) {
    std::fprintf(stderr, "%s\n", loaded.error().message.c_str());
    return false;
  }
  const FileBytes there = read_file(path);
  const std::vector<Contact> contacts = collide(model);
  const char* difference = there != to_bytes(**loaded)     ? "saved again it has other bytes"
                           : there != to_bytes(model)      ? "the model built here has other bytes"
                           : contacts.empty()              ? "its poses give no contacts"
                           : contacts != collide(**loaded) ? "it gives other contacts"
                                                           : nullptr;
  if (difference != nullptr) std::fprintf(stderr, "%s: %s\n", path.c_str(), difference);
  return difference == nullptr;
}

}  // namespace

int main(int argc, char** argv) {
  const std::string_view command = argc == 3 ? argv[1] : "";
  if (command != "write" && command != "check") {
    std::fprintf(stderr, "usage: %s write|check FOLDER\n", argv[0]);
    return 2;
  }
  std::size_t done = 0;
  for (const auto& [name, model] : traveling_models()) {
    const std::string path = std::string(argv[2]) + "/" + name + ".vxs";
    if ((command == "write" ? write_file : check_file)(path, *model)) ++done;
  }
  std::printf("%zu of %zu\n", done, traveling_models().size());
  return done == traveling_models().size() ? 0 : 1;
}
