#include "tests/shared.h"

#include <cstdlib>

namespace throng {

std::filesystem::path source_file(const std::string& name) {
    const char* elsewhere = std::getenv("THRONG_SOURCE");
    return std::filesystem::path(elsewhere ? elsewhere : THRONG_SOURCE_DIR) / name;
}

std::filesystem::path shared_folder(const std::string& name) {
    const char* elsewhere = std::getenv("THRONG_SHARED");
    return std::filesystem::path(elsewhere ? elsewhere : THRONG_SHARED_DIR) / name;
}

}  // namespace throng
