#include "tests/subset.h"

#include <gtest/gtest.h>

#include <cstdio>
#include <cstdlib>
#include <stdexcept>
#include <string>

int main(int argc, char** argv) try {
    testing::InitGoogleTest(&argc, argv);
    if (argc == 3 && argv[1] == std::string("--subset"))
        GTEST_FLAG_SET(filter, throng::test::filter_of_subset(argv[2]));
    else if (argc > 1)
        throw std::runtime_error("--subset NAME is the only option beside those of GoogleTest");
    // Costs that somebody has measured here must not change what is tested, and nothing is kept; no folder of
    // /dev/null can be made. Mesa's cache of shaders lies in the same folder, and stays.
    const char *cache = std::getenv("XDG_CACHE_HOME"), *home = std::getenv("HOME");
    if (cache || home) setenv("MESA_SHADER_CACHE_DIR", cache ? cache : (std::string(home) + "/.cache").c_str(), 0);
    setenv("XDG_CACHE_HOME", "/dev/null", 1);
    return RUN_ALL_TESTS();
} catch (const std::runtime_error& error) {
    std::fprintf(stderr, "%s: %s\n", argv[0], error.what());
    return 1;
}
