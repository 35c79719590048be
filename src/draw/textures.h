// Textures of materials: decoded from a character's images, uploaded with mipmaps.
#pragma once

#include "draw/image.h"
#include "gpu/upload.h"

#include <throng/character.h>
#include <throng/draw.h>

#include <optional>

namespace throng {

inline constexpr uint32_t kTextureDimensionLimit = 16'384;
inline constexpr uint64_t kTexturePixelLimit = uint64_t{1} << 26;  // 256 MiB decoded
// Size of all textures of a crowd, with mipmaps: a small file may ask for a lot
inline constexpr uint64_t kTexturesLimit_bytes = uint64_t{1} << 31;

// PNG or JPEG. Takes what it needs with mipmaps from `room_bytes`, before it decodes. Throws kInvalidFile, and kLimit
// above the limits.
Picture decode_image(const AssetImage& image, uint64_t& room_bytes);

inline constexpr VkFormat kColorTexture = VK_FORMAT_R8G8B8A8_SRGB, kNumberTexture = VK_FORMAT_R8G8B8A8_UNORM;

// A texture, in SHADER_READ_ONLY_OPTIMAL when the uploads have finished; it must live until then.
Image upload_texture(Uploads& uploads, std::string_view what, const Picture& picture, VkFormat format);

// What the textures of a group are made with.
struct TextureAccount {
    std::vector<std::string>& warnings;
    uint64_t& room_bytes;  // of kTexturesLimit_bytes
};

// The decoded image; none, with a warning that it is drawn white, where it cannot be decoded or is too much.
std::optional<Picture> decode_or_none(const AssetImage& image, TextureAccount& account);
// The texture of an image; none, with a warning that it is drawn white, where it cannot be decoded or there is no room
// for it. As upload_texture().
std::optional<Image> make_texture(Uploads& uploads, const AssetImage& image, VkFormat format, TextureAccount& account);
// Submits and waits.
Image make_white_texture(const std::shared_ptr<Gpu>& gpu);

}  // namespace throng
