#include "tests/subset.h"
#include "tests/without_cache.h"

#include <gtest/gtest.h>

#include <cstdio>
#include <stdexcept>
#include <string>

int main(int argc, char** argv) try {
    testing::InitGoogleTest(&argc, argv);
    if (argc == 3 && argv[1] == std::string("--subset"))
        GTEST_FLAG_SET(filter, throng::test::filter_of_subset(argv[2]));
    else if (argc > 1)
        throw std::runtime_error("--subset NAME is the only option beside those of GoogleTest");
    throng::test::leave_cache_folder();
    return RUN_ALL_TESTS();
} catch (const std::runtime_error& error) {
    std::fprintf(stderr, "%s: %s\n", argv[0], error.what());
    return 1;
}
