// The commands of `throng`.
#pragma once

#include "tools/cli/options.h"

namespace throng::tools {

// Each adds one subcommand, which runs when it is parsed.
void add_info(Command app);
void add_compile(Command app);
void add_controller(Command app);
void add_pose(Command app);
void add_render(Command app);
void add_generate(Command app);
void add_devices(Command app);

}  // namespace throng::tools
