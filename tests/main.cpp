#include "tests/test_device.h"

#include <cstdlib>

int main(int argc, char** argv) {
    testing::InitGoogleTest(&argc, argv);
    setenv("XDG_CACHE_HOME", "/nonexistent", 1);  // costs that somebody has measured here must not change what is tested
    return RUN_ALL_TESTS();
}
