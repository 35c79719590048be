// `throng bench isa`: what AMD's compiler makes of every kernel, and the least time that the code takes on known GPUs.
#pragma once

#include "bench/record.h"
#include "bench/rounds.h"

#include <string>
#include <vector>

namespace throng::bench {

// Which kernels: those of visit_default_forms() (bench/isa/configurations.h), or all.
enum class IsaScope { kDefaultForms, kAll };

// A record for each kernel of each configuration, and one for each time that is predicted (bench/README.md lists their
// fields). `family` is one of compiled_families(). Throws kNoDevice where the driver is not installed.
std::vector<Json> measure_isa(const std::string& family, IsaScope scope, const Progress& progress);

}  // namespace throng::bench
