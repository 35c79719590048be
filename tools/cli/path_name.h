// The name of the path by which a group is updated, on the command line and in the records of benchmarks.
#pragma once

#include <throng/crowd.h>

#include <string>

namespace throng::tools {

// "fused", "staged", "native, fused"
inline std::string path_name(const GroupPath& path) {
    return std::string(path.is_native ? "native, " : "") + (path.is_fused ? "fused" : "staged");
}

}  // namespace throng::tools
