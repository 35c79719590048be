// How errors name a file or a character.
#pragma once

#include "base/text.h"

#include <string>
#include <string_view>

namespace throng {

inline std::string message_name(std::string_view name) { return name.empty() ? "(no name)" : printable(name, 120); }

}  // namespace throng
