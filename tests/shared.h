// Where tests find repository files and shared material, and macros to skip tests.
#pragma once

#include <gtest/gtest.h>

#include <chrono>
#include <filesystem>
#include <string>

namespace throng {

// A file of the repository, or of the folder THRONG_SOURCE, which has some of them if the tests run from a bundle.
std::filesystem::path source_file(const std::string& name);

// A folder of the shared material (characters, goldens, invalid). Tests skip if it is missing.
std::filesystem::path shared_folder(const std::string& name);

#if defined(__SANITIZE_ADDRESS__)
inline constexpr bool kSanitized = true;
#elif defined(__has_feature)
inline constexpr bool kSanitized = __has_feature(address_sanitizer);
#else
inline constexpr bool kSanitized = false;
#endif

// What takes longer hangs: no file of the tests takes a tenth as long on a busy machine, under sanitizers.
inline constexpr std::chrono::seconds kHang{60};

}  // namespace throng

// For tests that take long under sanitizers, and either repeat other tests with more data or run no library code that
// other tests do not.
#define THRONG_SKIP_WHERE_SANITIZED() \
    if (throng::kSanitized) GTEST_SKIP() << "it takes long under sanitizers"

#define THRONG_SKIP_WITHOUT(folder) \
    if (!std::filesystem::exists(folder)) GTEST_SKIP() << (folder).string() << " is not there"
