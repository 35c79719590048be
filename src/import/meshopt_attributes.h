// Version 1 of the codec that compresses vertex attributes, which KHR_meshopt_compression brought. The meshoptimizer of
// our packages (0.18) decodes version 0 only.
// Source: "KHR_meshopt_compression", glTF extension by Arseny Kapoulkine and others, Appendix A, mode 0.
#pragma once

#include "base/progress.h"
#include "json/json_view.h"

#include <cstddef>
#include <span>

namespace throng::gltf {

// The first byte of such data.
inline constexpr std::byte kAttributesVersion1{0xA1};

// The least size that `count` elements can be compressed to.
uint64_t least_attributes_bytes(uint64_t count, uint64_t stride_bytes);

// Fills `out`, whose size is a multiple of the stride; the stride is a multiple of 4, 256 at most. Data that break the
// format fail at the place of `json`.
void decode_attributes(const JsonView& json, std::span<const std::byte> compressed, size_t stride_bytes,
                       std::span<std::byte> out, const Progress& progress);

}  // namespace throng::gltf
