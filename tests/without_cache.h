// Tests keep nothing in the user's cache folder, and find nothing there.
#pragma once

#include <cstdlib>
#include <string>

namespace throng::test {

// Costs that somebody has measured here must not change what is tested; no folder of /dev/null can be made. Mesa's
// cache of shaders lies in the same folder, and stays.
inline void leave_cache_folder() {
    const char *cache = std::getenv("XDG_CACHE_HOME"), *home = std::getenv("HOME");
    if (cache || home) setenv("MESA_SHADER_CACHE_DIR", cache ? cache : (std::string(home) + "/.cache").c_str(), 0);
    setenv("XDG_CACHE_HOME", "/dev/null", 1);
}

}  // namespace throng::test
