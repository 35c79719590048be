// Textures, as the kernels sample them.
#pragma once

#include "raster/frame.h"

#include <throng/draw.h>

#include <vector>

namespace throng::raster {

enum class TexelKind { kColor, kNumbers };  // sRGB except for alpha, or linear

// All mips, each filtered from the one before as a linear blit does (draw/textures.cpp).
class OwnedTexture {
public:
    OwnedTexture(const Picture& picture, TexelKind kind);
    OwnedTexture(OwnedTexture&&) = default;  // texels stay where they are
    OwnedTexture& operator=(OwnedTexture&&) = default;

    const Texture& texture() const { return texture_; }

private:
    std::vector<uint64_t> texels_;
    Texture texture_;
};

}  // namespace throng::raster
