// Asks coal and voxshell in turn whether the bunny touches the bunny, at poses from a file, and
// writes every answer and time as JSON. `./dev bench --peers` runs it and works out the rest.
#include <array>
#include <charconv>
#include <chrono>
#include <cstdio>
#include <fstream>
#include <string_view>
#include <utility>

#include "bodies.h"
#include "question.h"
#include "voxshell/contacts.h"

namespace {

using namespace voxshell;
using namespace voxshell::benchmarks;
using Clock = std::chrono::steady_clock;

template <class T>
bool read_number(std::string_view text, T& number) {
  const char* end = text.data() + text.size();
  const auto [stop, error] = std::from_chars(text.data(), end, number);
  return error == std::errc{} && stop == end && number > 0;
}

/// 16 doubles a pose, by rows, as they lie in memory. Empty where the file cannot be read as such.
std::vector<Pose> read_poses(const char* path) {
  std::vector<Pose> poses;
  std::ifstream file(path, std::ios::binary);
  std::array<double, 16> matrix{};
  while (file.read(reinterpret_cast<char*>(matrix.data()), sizeof(matrix))) {
    const auto pose = Pose::from_matrix(matrix);
    if (!pose) return {};
    poses.push_back(*pose);
  }
  return poses;
}

/// By repeat, then pose.
using Seconds = std::vector<std::vector<double>>;

/// One after another asks about all poses, twice: the first time brings what it needs back into the
/// caches, the second is timed.
std::vector<Seconds> time_in_turn(const std::vector<Question>& questions, std::size_t poses,
                                  std::size_t repeats) {
  std::vector<Seconds> seconds(questions.size(), Seconds(repeats, std::vector<double>(poses)));
  std::vector<char> answers(poses);
  for (std::size_t repeat = 0; repeat < repeats; ++repeat) {
    for (std::size_t q = 0; q < questions.size(); ++q) {
      const auto& ask = questions[q].ask;
      for (std::size_t i = 0; i < poses; ++i) answers[i] = ask(i) ? 1 : 0;
      for (std::size_t i = 0; i < poses; ++i) {
        const Clock::time_point start = Clock::now();
        answers[i] = ask(i) ? 1 : 0;
        seconds[q][repeat][i] = std::chrono::duration<double>(Clock::now() - start).count();
      }
    }
  }
  return seconds;
}

void print_json(const std::vector<Question>& questions, const std::vector<Seconds>& seconds,
                std::size_t poses) {
  std::printf("{\"compiler\": \"%s\", \"flags\": \"%s\", \"questions\": {", VOXSHELL_COMPILER,
              VOXSHELL_FLAGS);
  for (std::size_t q = 0; q < questions.size(); ++q) {
    std::printf("%s\n\"%s\": {\"answers\": [", q == 0 ? "" : ",", questions[q].name.c_str());
    for (std::size_t i = 0; i < poses; ++i) {
      std::printf("%s%d", i == 0 ? "" : ", ", questions[q].ask(i) ? 1 : 0);
    }
    std::printf("], \"seconds\": [");
    for (std::size_t repeat = 0; repeat < seconds[q].size(); ++repeat) {
      std::printf("%s\n[", repeat == 0 ? "" : ",");
      for (std::size_t i = 0; i < poses; ++i) {
        std::printf("%s%.9f", i == 0 ? "" : ", ", seconds[q][repeat][i]);
      }
      std::printf("]");
    }
    std::printf("]}");
  }
  std::printf("}}\n");
}

}  // namespace

int main(int argc, char** argv) {
  Settings settings;
  std::size_t repeats = 0;
  if (argc != 6 || !read_number(argv[3], settings.resolution) ||
      !read_number(argv[4], settings.fine_points) || !read_number(argv[5], repeats)) {
    std::fputs("usage: voxshell_beside_coal MESH.obj POSES RESOLUTION POINTS REPEATS\n", stderr);
    return 2;
  }
  settings.bunny_path = argv[1];
  const std::vector<Pose> world_from_a = read_poses(argv[2]);
  if (world_from_a.empty()) {
    std::fprintf(stderr, "voxshell_beside_coal: no poses in %s\n", argv[2]);
    return 2;
  }
  Bodies bodies(settings);
  const Model& bunny = bodies.bunny();
  const Pose world_from_b{};
  std::vector<Question> questions = make_coal_questions(bodies.bunny_mesh(), world_from_a);
  questions.push_back({"voxshell", [&](std::size_t pose) {
                         // coal's calls take the poses of both bodies as well.
                         const Pose b_from_a = world_from_b.inverse() * world_from_a[pose];
                         return collides(bunny.field(), bunny.shell(), b_from_a);
                       }});
  const std::vector<Seconds> seconds = time_in_turn(questions, world_from_a.size(), repeats);
  print_json(questions, seconds, world_from_a.size());
  return 0;
}
