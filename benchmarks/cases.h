#pragma once

#include "bodies.h"

namespace voxshell::benchmarks {

// Each registers its cases with google-benchmark under names `scene/query/visit` or `what/model`;
// their figures are user counters. `bodies` outlives the run.
void register_query_cases(Bodies& bodies);
void register_scaling_cases(Bodies& bodies);
void register_build_cases(Bodies& bodies);
void register_load_cases(Bodies& bodies);
void register_batch_cases(Bodies& bodies);

}  // namespace voxshell::benchmarks
