// Textures of materials: decoded from a character's images, uploaded with mipmaps.
#pragma once

#include "draw/image.h"
#include "gpu/upload.h"
#include "raster/texture.h"

#include <throng/character.h>
#include <throng/draw.h>

#include <memory>
#include <string>
#include <vector>

namespace throng {

inline constexpr uint64_t kTexturePixelLimit = uint64_t{1} << 26;  // 256 MiB decoded
// Size of all textures of a crowd, with mipmaps: a small file may ask for a lot
inline constexpr uint64_t kTexturesLimit_bytes = uint64_t{1} << 31;

// Subtracts the size of an image with mipmaps from `room_bytes`. Throws kInvalidFile if the image cannot be read, and
// kLimit above the limits.
void take_room(const AssetImage& image, uint64_t& room_bytes);
// Decodes an image's file, unless something on the device holds the picture already. Throws kInvalidFile.
std::shared_ptr<const Picture> decoded_picture(Gpu& gpu, const AssetImage& image);

inline constexpr VkFormat kColorTexture = VK_FORMAT_R8G8B8A8_SRGB, kNumberTexture = VK_FORMAT_R8G8B8A8_UNORM;

// A texture, in SHADER_READ_ONLY_OPTIMAL when the uploads have finished.
std::shared_ptr<const Image> upload_texture(Uploads& uploads, std::string_view what, const Picture& picture,
                                            VkFormat format);

// What the textures of a group are made with.
struct TextureAccount {
    std::vector<std::string>& warnings;
    uint64_t& room_bytes;    // left of kTexturesLimit_bytes
    SharedValues& textures;  // where made textures are found by image: a Vulkan renderer's own, or the device's
};

// Null, with a warning that the image is drawn white, if it cannot be decoded or there is no room for it.
std::shared_ptr<const Picture> decode_or_none(Gpu& gpu, const AssetImage& image, TextureAccount& account);
// The texture of an image; null, with a warning that it is drawn white, if it cannot be decoded or there is no room for
// it. One found in account.textures has been uploaded, or is among these uploads: draw with it only when they have
// finished.
std::shared_ptr<const Image> make_texture(Uploads& uploads, const AssetImage& image, bool is_color,
                                          TextureAccount& account);
// For the native renderer.
std::shared_ptr<const raster::OwnedTexture> make_native_texture(Gpu& gpu, const AssetImage& image, bool is_color,
                                                                TextureAccount& account);
// A white texture, one for all groups of a renderer; draw with it only when the uploads have finished.
std::shared_ptr<const Image> make_white_texture(Uploads& uploads, SharedValues& textures);

}  // namespace throng
