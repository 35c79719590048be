#pragma once

#include <CLI/CLI.hpp>

namespace throng::tools {

// throng bench frame.
void add_bench_frame(CLI::App& bench);

}  // namespace throng::tools
