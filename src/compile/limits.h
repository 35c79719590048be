// The limits of a compiled character: the compiler keeps them, and a compiled file is checked against them.
#pragma once

#include <cstddef>
#include <cstdint>

namespace throng {

inline constexpr size_t kJointLimit = 65'535;
inline constexpr size_t kPaletteLimit = 65'536;  // an influence names its entry in 16 bits
// Rows of all clips, times joints: minutes of measuring
inline constexpr uint64_t kPackingLimit = uint64_t{1} << 28;
// Each costs every instance of a crowd a little time
inline constexpr size_t kMorphLimit = 4'096;
// Size of the keys, of the packed words and of the track table; of those of morphs likewise
inline constexpr uint64_t kKeyLimit_bytes = uint64_t{256} << 20;

}  // namespace throng
