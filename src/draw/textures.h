// Textures of materials: decoded from a character's images, uploaded with mipmaps.
#pragma once

#include "draw/image.h"

#include <throng/character.h>
#include <throng/draw.h>

namespace throng {

inline constexpr uint32_t kTextureDimensionLimit = 16'384;
inline constexpr uint64_t kTexturePixelLimit = uint64_t{1} << 26;  // 256 MiB decoded

// PNG or JPEG. Throws kInvalidFile, and kLimit above the limits.
Picture decode_image(const AssetImage& image);

inline constexpr VkFormat kColorTexture = VK_FORMAT_R8G8B8A8_SRGB, kNumberTexture = VK_FORMAT_R8G8B8A8_UNORM;

// A texture in SHADER_READ_ONLY_OPTIMAL. Submits and waits.
Image upload_texture(const std::shared_ptr<Gpu>& gpu, std::string_view what, const Picture& picture, VkFormat format);

// The texture of an image; white, with a warning, where it cannot be decoded. Submits and waits.
Image make_texture(const std::shared_ptr<Gpu>& gpu, const AssetImage& image, VkFormat format, std::vector<std::string>& warnings);
Image make_white_texture(const std::shared_ptr<Gpu>& gpu);

}  // namespace throng
