// The limits of a compiled character. The compiler enforces them, and compiled files are checked against them.
#pragma once

#include <throng/asset.h>

#include <cstddef>
#include <cstdint>

namespace throng {

inline constexpr size_t kJointLimit = 65'535;
inline constexpr size_t kPaletteLimit = 65'536;  // an influence names its entry in 16 bits
// Rows of all clips, or of shared poses, times joints. This many take minutes to measure
inline constexpr uint64_t kPackingLimit = uint64_t{1} << 28;
// Each morph costs every instance of a crowd a little time
inline constexpr size_t kMorphLimit = 4'096;
// Limits each of these arrays on its own: keys, packed words, root rows, the track table; deltas, tracks and values of
// morphs
inline constexpr uint64_t kKeyLimit_bytes = uint64_t{256} << 20;

// Vertices with their influences, indices, and names of sections; a mesh counts once for each node that shows it
inline constexpr uint64_t kMeshLimit_bytes = uint64_t{2} << 30;
// Each section is a draw in every crowd that has the character
inline constexpr size_t kSectionLimit = 262'144;

// The last value of an enumeration whose values come from files and applications.
template <class Enum>
inline constexpr Enum last_of{};
template <>
inline constexpr Interpolation last_of<Interpolation> = Interpolation::kCubicSpline;
template <>
inline constexpr TrackTarget last_of<TrackTarget> = TrackTarget::kScale;
template <>
inline constexpr AlphaMode last_of<AlphaMode> = AlphaMode::kBlend;
template <>
inline constexpr TextureFilter last_of<TextureFilter> = TextureFilter::kNearest;
template <>
inline constexpr TextureWrap last_of<TextureWrap> = TextureWrap::kMirror;

inline bool has_known_values(const AssetMaterial& material) {
    return material.alpha_mode <= last_of<AlphaMode> && material.filter <= last_of<TextureFilter> &&
           material.wrap_u <= last_of<TextureWrap> && material.wrap_v <= last_of<TextureWrap>;
}

}  // namespace throng
