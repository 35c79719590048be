#include "draw/textures.h"

#include "base/failure.h"
#include "gpu/buffer.h"

#include <algorithm>
#include <bit>
#include <limits>

// Static, so that an application may have an stb of its own.
#define STB_IMAGE_STATIC
#define STB_IMAGE_IMPLEMENTATION
#define STBI_ONLY_PNG
#define STBI_ONLY_JPEG
#define STBI_NO_STDIO
#define STBI_MAX_DIMENSIONS 16384
#include <stb/stb_image.h>

namespace throng {

static_assert(STBI_MAX_DIMENSIONS == kTextureDimensionLimit);

Picture decode_image(const AssetImage& image, uint64_t& room_bytes) {
    const std::string place = "image '" + image.name + "'";
    if (image.encoded.empty()) throw Failure(ErrorCode::kInvalidFile, place, "has no content");
    if (image.encoded.size() > static_cast<size_t>(std::numeric_limits<int>::max()))
        throw Failure(ErrorCode::kLimit, place, "is larger than 2 GiB");
    const auto* bytes = reinterpret_cast<const stbi_uc*>(image.encoded.data());
    const int size_bytes = static_cast<int>(image.encoded.size());
    int width = 0, height = 0, channels = 0;
    const auto refuse = [&] {
        return Failure(ErrorCode::kInvalidFile, place, std::string("cannot be decoded: ") + stbi_failure_reason());
    };
    if (!stbi_info_from_memory(bytes, size_bytes, &width, &height, &channels)) throw refuse();
    const uint64_t pixel_count = static_cast<uint64_t>(width) * static_cast<uint64_t>(height),
                   with_mips_bytes = pixel_count * 4 * 4 / 3;
    const std::string size = std::to_string(width) + " x " + std::to_string(height);
    if (pixel_count > kTexturePixelLimit)
        throw Failure(ErrorCode::kLimit, place,
                      size + " exceeds the limit of " + std::to_string(kTexturePixelLimit) + " pixels");
    if (with_mips_bytes > room_bytes)
        throw Failure(ErrorCode::kLimit, place,
                      size + " is more than the other textures leave of the limit of " +
                          std::to_string(kTexturesLimit_bytes) + " bytes for those of a crowd");
    room_bytes -= with_mips_bytes;
    const std::unique_ptr<stbi_uc, decltype(&stbi_image_free)> pixels(
        stbi_load_from_memory(bytes, size_bytes, &width, &height, &channels, STBI_rgb_alpha), &stbi_image_free);
    if (!pixels) throw refuse();
    Picture picture{.width = static_cast<uint32_t>(width), .height = static_cast<uint32_t>(height)};
    picture.rgba.assign(pixels.get(), pixels.get() + uint64_t{picture.width} * picture.height * 4);
    return picture;
}

Image upload_texture(Uploads& uploads, std::string_view what, const Picture& picture, VkFormat format) {
    const auto mip_count = static_cast<uint32_t>(std::bit_width(std::max(picture.width, picture.height)));
    Image texture(uploads.gpu(), {.what = what,
                                  .extent = {picture.width, picture.height},
                                  .mip_count = mip_count,
                                  .format = format,
                                  .usage = VK_IMAGE_USAGE_SAMPLED_BIT | VK_IMAGE_USAGE_TRANSFER_SRC_BIT |
                                           VK_IMAGE_USAGE_TRANSFER_DST_BIT});
    const auto record = [gpu = uploads.gpu().get(), image = texture.handle(), width = picture.width,
                         height = picture.height, mip_count](VkCommandBuffer commands, const BufferRange& staged) {
        transition(*gpu, commands, image, discarded_after(kNoAccess), kCopyTarget);
        const VkBufferImageCopy copy{.bufferOffset = staged.offset_bytes,
                                     .imageSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 0, 1},
                                     .imageExtent = {width, height, 1}};
        gpu->vk.vkCmdCopyBufferToImage(commands, staged.buffer, image, kCopyTarget.layout, 1, &copy);

        const auto corner = [&](uint32_t mip) {
            return VkOffset3D{static_cast<int32_t>(std::max(width >> mip, 1u)),
                              static_cast<int32_t>(std::max(height >> mip, 1u)), 1};
        };
        for (uint32_t mip = 1; mip < mip_count; ++mip) {
            transition(*gpu, commands, image, kCopyTarget, kCopySource, mip - 1, 1);
            const VkImageBlit blit{.srcSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, mip - 1, 0, 1},
                                   .srcOffsets = {{}, corner(mip - 1)},
                                   .dstSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, mip, 0, 1},
                                   .dstOffsets = {{}, corner(mip)}};
            gpu->vk.vkCmdBlitImage(commands, image, kCopySource.layout, image, kCopyTarget.layout, 1, &blit,
                                   VK_FILTER_LINEAR);
        }
        if (mip_count > 1) transition(*gpu, commands, image, kCopySource, kTexture, 0, mip_count - 1);
        transition(*gpu, commands, image, kCopyTarget, kTexture, mip_count - 1, 1);
    };
    uploads.add(std::as_bytes(std::span(picture.rgba)), record);
    return texture;
}

namespace {

// What `make` returns; none, with a warning, where that is no more than a texture the less.
template <class Make>
std::optional<std::invoke_result_t<Make>> or_white(TextureAccount& account, const Make& make) {
    try {
        return make();
    } catch (const Failure& failure) {
        const ErrorCode code = failure.error.code;
        if (code != ErrorCode::kInvalidFile && code != ErrorCode::kLimit && code != ErrorCode::kOutOfMemory) throw;
        account.warnings.push_back(failure.error.text() + "; drawn white");
        return std::nullopt;
    }
}

}  // namespace

std::optional<Picture> decode_or_none(const AssetImage& image, TextureAccount& account) {
    return or_white(account, [&] { return decode_image(image, account.room_bytes); });
}

std::optional<Image> make_texture(Uploads& uploads, const AssetImage& image, VkFormat format, TextureAccount& account) {
    const std::optional<Picture> picture = decode_or_none(image, account);
    if (!picture) return std::nullopt;
    uploads.make_room(picture->rgba.size());  // none of this texture's, where it fails
    return or_white(account, [&] { return upload_texture(uploads, "image '" + image.name + "'", *picture, format); });
}

Image make_white_texture(const std::shared_ptr<Gpu>& gpu) {
    Uploads uploads(gpu);
    Image texture = upload_texture(uploads, "white texture", {.width = 1, .height = 1, .rgba = {255, 255, 255, 255}},
                                   kColorTexture);
    uploads.finish();
    return texture;
}

}  // namespace throng
