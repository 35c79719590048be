// Keeps tests from reading or writing the user's cache folder.
#pragma once

#include <cstdlib>
#include <string>

namespace throng::test {

// Costs measured on this machine must not influence the tests. No folder can be created below /dev/null. Mesa's shader
// cache is in the same folder, and stays in use.
inline void leave_cache_folder() {
    const char *cache = std::getenv("XDG_CACHE_HOME"), *home = std::getenv("HOME");
    if (cache || home) setenv("MESA_SHADER_CACHE_DIR", cache ? cache : (std::string(home) + "/.cache").c_str(), 0);
    setenv("XDG_CACHE_HOME", "/dev/null", 1);
}

}  // namespace throng::test
