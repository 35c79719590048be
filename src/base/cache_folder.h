// The folder where throng caches measurements of this machine.
#pragma once

#include <cstdlib>
#include <filesystem>

namespace throng {

// $XDG_CACHE_HOME/throng, or ~/.cache/throng; empty if neither variable is set. The folder need not exist. A relative
// XDG_CACHE_HOME is ignored (XDG Base Directory Specification 0.8).
inline std::filesystem::path cache_folder() {
    if (const char* cache = std::getenv("XDG_CACHE_HOME"); cache && *cache == '/')
        return std::filesystem::path(cache) / "throng";
    if (const char* home = std::getenv("HOME"); home && *home) return std::filesystem::path(home) / ".cache" / "throng";
    return {};
}

}  // namespace throng
