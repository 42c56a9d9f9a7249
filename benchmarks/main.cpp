// Times the core's queries and builds. `./dev bench` runs it and makes a table of what it finds.
#include <benchmark/benchmark.h>
#include <charconv>
#include <cstdio>
#include <cstring>
#include <string>
#include <string_view>
#include <system_error>

#include "cases.h"
#include "query_timer.h"

namespace {

using voxshell::benchmarks::Settings;

template <class T>
bool read(std::string_view argument, std::string_view name, T& value) {
  if (!argument.starts_with(name)) return false;
  argument.remove_prefix(name.size());
  const char* end = argument.data() + argument.size();
  const auto [stop, error] = std::from_chars(argument.data(), end, value);
  return error == std::errc{} && stop == end;
}

bool read_argument(std::string_view argument, Settings& settings) {
  if (argument == "--quick") {
    settings.quick = true;
    settings.poses = 60;
    settings.cold_poses = 20;
    settings.seconds = 0.1;
    return true;
  }
  if (read(argument, "--poses=", settings.poses)) {
    settings.cold_poses = settings.poses;
    return settings.poses > 0;
  }
  return read(argument, "--resolution=", settings.resolution) ||
         read(argument, "--seconds=", settings.seconds) ||
         read(argument, "--build_limit=", settings.build_limit);
}

}  // namespace

int main(int argc, char** argv) {
  benchmark::Initialize(&argc, argv);
  Settings settings;
  for (int i = 1; i < argc; ++i) {
    if (!read_argument(argv[i], settings)) {
      std::fprintf(stderr,
                   "voxshell_benchmarks: cannot take %s; after google-benchmark's own options "
                   "come --quick, --poses=N, --resolution=N, --seconds=S, --build_limit=S\n",
                   argv[i]);
      return 2;
    }
  }
  voxshell::benchmarks::Bodies bodies(settings);
  voxshell::benchmarks::register_build_cases(bodies);
  voxshell::benchmarks::register_load_cases(bodies);
  voxshell::benchmarks::register_query_cases(bodies);
  voxshell::benchmarks::register_batch_cases(bodies);
  voxshell::benchmarks::register_scaling_cases(bodies);
  benchmark::AddCustomContext("compiler", VOXSHELL_COMPILER);
  benchmark::AddCustomContext("flags", VOXSHELL_FLAGS);
  benchmark::AddCustomContext("resolution", std::to_string(settings.resolution));
  benchmark::AddCustomContext("clock_overhead_us",
                              std::to_string(voxshell::benchmarks::clock_overhead()));
  benchmark::RunSpecifiedBenchmarks();
  benchmark::Shutdown();
  return 0;
}
