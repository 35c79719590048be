// The formats of skin matrices, on the host.
#pragma once

#include <throng/character.h>
#include <throng/skin_format.h>

#include <cstddef>
#include <span>
#include <string>
#include <vector>

namespace throng {

// Why a character's skin matrices cannot be stored in this format; empty if they can.
std::string skin_format_unsupported_reason(SkinFormat format, const Character& character);

// Why its vertices cannot be blended this way; empty if they can.
std::string skin_blend_unsupported_reason(SkinBlend blend, const Character& character);

// Unpacks matrices that were read back.
std::vector<Affine> unpack_skin(SkinFormat format, std::span<const std::byte> bytes);

}  // namespace throng
