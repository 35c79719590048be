// The command `throng view`.
#pragma once

#include "tools/cli/options.h"

namespace throng::tools {

// Adds the subcommand, which runs when it is parsed.
void add_view(Command app);

}  // namespace throng::tools
