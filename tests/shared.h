// What tests find beside the repository.
#pragma once

#include <gtest/gtest.h>

#include <filesystem>
#include <string>

namespace throng {

// A file of the repository; of the folder THRONG_SOURCE, where a bundle of the tests has some of them.
std::filesystem::path source_file(const std::string& name);

// A folder of the shared material (characters, goldens, invalid); a test skips where it is missing.
std::filesystem::path shared_folder(const std::string& name);

#if defined(__SANITIZE_ADDRESS__)
inline constexpr bool kSanitized = true;
#elif defined(__has_feature)
inline constexpr bool kSanitized = __has_feature(address_sanitizer);
#else
inline constexpr bool kSanitized = false;
#endif

}  // namespace throng

// For tests that take long then, and only repeat with more data what others do, or run nothing of the library's that
// others do not.
#define THRONG_SKIP_WHERE_SANITIZED() \
    if (throng::kSanitized) GTEST_SKIP() << "it takes long under sanitizers"

#define THRONG_SKIP_WITHOUT(folder) \
    if (!std::filesystem::exists(folder)) GTEST_SKIP() << (folder).string() << " is not there"
