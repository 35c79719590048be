// Which version of throng this is. Versions are numbered as semver.org has it.
#pragma once

// The version of the headers that a program is compiled with
#define THRONG_VERSION_MAJOR 1
#define THRONG_VERSION_MINOR 0
#define THRONG_VERSION_PATCH 0

namespace throng {

// "1.0.0": of the library that the program runs with, which may be a later one.
const char* version();

}  // namespace throng
