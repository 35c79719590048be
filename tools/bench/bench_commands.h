// The commands of `throng-bench`.
#pragma once

#include "tools/cli/options.h"

namespace throng::tools {

// Each adds one subcommand, which runs when it is parsed.
void add_bench(Command app);
void add_tune(Command app);

// The subcommands of `bench`.
void add_bench_frame(Command bench);
void add_bench_cpu(Command bench);
void add_bench_control(Command bench);
void add_bench_isa(Command bench);
void add_bench_view(Command bench);
void add_bench_million(Command bench);
void add_bench_population(Command bench);
void add_bench_draw(Command bench);
void add_bench_scan(Command bench);
void add_bench_baselines(Command bench);
void add_bench_report(Command bench);
void add_bench_summary(Command bench);
void add_bench_diagrams(Command bench);

}  // namespace throng::tools
