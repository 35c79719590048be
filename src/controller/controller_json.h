// Controllers as JSON: docs/controller.md, docs/controller.schema.json.
#pragma once

#include "controller/json_lines.h"

#include <throng/controller.h>

namespace throng {

// Types, fields and their order; what the values mean to each other is for check_rules(). Throws kInvalidFile at
// `file`, line and place.
Controller read_controller(const JsonNode& root, const std::string& file);

}  // namespace throng
