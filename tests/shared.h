// What tests find beside the repository.
#pragma once

#include <gtest/gtest.h>

#include <filesystem>
#include <string>

namespace throng {

// A folder of the shared material (characters, goldens, invalid); a test skips where it is missing.
std::filesystem::path shared_folder(const std::string& name);

}  // namespace throng

#define THRONG_SKIP_WITHOUT(folder) \
    if (!std::filesystem::exists(folder)) GTEST_SKIP() << (folder).string() << " is not there"
