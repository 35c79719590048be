#include <gtest/gtest.h>

#include <cstdlib>
#include <string>

int main(int argc, char** argv) {
    testing::InitGoogleTest(&argc, argv);
    // Costs that somebody has measured here must not change what is tested, and nothing is kept; no folder of
    // /dev/null can be made. Mesa's cache of shaders lies in the same folder, and stays.
    const char *cache = std::getenv("XDG_CACHE_HOME"), *home = std::getenv("HOME");
    if (cache || home) setenv("MESA_SHADER_CACHE_DIR", cache ? cache : (std::string(home) + "/.cache").c_str(), 0);
    setenv("XDG_CACHE_HOME", "/dev/null", 1);
    return RUN_ALL_TESTS();
}
