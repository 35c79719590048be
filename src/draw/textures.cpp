#include "draw/textures.h"

#include "base/failure.h"
#include "crowd/shared_images.h"
#include "draw/image_file.h"
#include "gpu/buffer.h"

#include <algorithm>
#include <bit>

namespace throng {

void take_room(const AssetImage& image, uint64_t& room_bytes) {
    const ImageFile file(image);
    const uint64_t pixel_count = uint64_t{file.width()} * file.height(), with_mips_bytes = pixel_count * 4 * 4 / 3;
    const std::string size = std::to_string(file.width()) + " x " + std::to_string(file.height());
    if (pixel_count > kTexturePixelLimit)
        throw Failure(ErrorCode::kLimit, file.place(),
                      size + " exceeds the limit of " + std::to_string(kTexturePixelLimit) + " pixels");
    if (with_mips_bytes > room_bytes)
        throw Failure(ErrorCode::kLimit, file.place(),
                      size + " does not fit: the crowd's other textures leave too little of the limit of " +
                          std::to_string(kTexturesLimit_bytes) + " bytes");
    room_bytes -= with_mips_bytes;
}

std::shared_ptr<const Picture> decoded_picture(Gpu& gpu, const AssetImage& image) {
    return gpu.values.get<Picture>(image_key(SharedValue::kPicture, image), [&] { return ImageFile(image).decode(); });
}

std::shared_ptr<const Image> upload_texture(Uploads& uploads, std::string_view what, const Picture& picture,
                                            VkFormat format) {
    const auto mip_count = static_cast<uint32_t>(std::bit_width(std::max(picture.width, picture.height)));
    const auto texture = std::make_shared<const Image>(
        uploads.gpu(), ImageSettings{.what = what,
                                     .extent = {picture.width, picture.height},
                                     .mip_count = mip_count,
                                     .format = format,
                                     .usage = VK_IMAGE_USAGE_SAMPLED_BIT | VK_IMAGE_USAGE_TRANSFER_SRC_BIT |
                                              VK_IMAGE_USAGE_TRANSFER_DST_BIT});
    const auto record = [gpu = uploads.gpu().get(), texture, width = picture.width, height = picture.height, mip_count](
                            VkCommandBuffer commands, const BufferRange& staged) {
        const VkImage image = texture->handle();
        transition(*gpu, commands, image, discarded_after(kFragmentRead), kCopyTarget);  // FrameUploads records again
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

// Returns the pointer that `make` returns; null, with a warning, if it fails in a way that costs only this texture. For
// an image without content, there was a warning when its file was read.
template <class Make>
std::invoke_result_t<Make> or_white(const AssetImage& image, TextureAccount& account, const Make& make) {
    if (image.encoded.empty()) return nullptr;
    try {
        return make();
    } catch (const Failure& failure) {
        const ErrorCode code = failure.error.code;
        if (code != ErrorCode::kInvalidFile && code != ErrorCode::kLimit && code != ErrorCode::kOutOfMemory) throw;
        account.warnings.push_back(failure.error.text() + "; drawn white");
    } catch (const std::bad_alloc&) {
        account.warnings.push_back("image '" + image.name + "': there is not enough memory to decode it; drawn white");
    }
    return nullptr;
}

SharedValues::Key texture_key(SharedValue kind, const AssetImage& image, bool is_color) {
    SharedValues::Key key = image_key(kind, image);
    key.push_back(is_color);
    return key;
}

}  // namespace

std::shared_ptr<const Picture> decode_or_none(Gpu& gpu, const AssetImage& image, TextureAccount& account) {
    return or_white(image, account, [&] {
        take_room(image, account.room_bytes);
        return decoded_picture(gpu, image);
    });
}

std::shared_ptr<const Image> make_texture(Uploads& uploads, const AssetImage& image, bool is_color,
                                          TextureAccount& account) {
    std::shared_ptr<const Image> found;
    const SharedValues::Key key = texture_key(SharedValue::kTexture, image, is_color);
    const auto picture = or_white(image, account, [&]() -> std::shared_ptr<const Picture> {
        take_room(image, account.room_bytes);
        found = account.textures.find<Image>(key);
        return found ? nullptr : decoded_picture(*uploads.gpu(), image);
    });
    if (!picture) return found;
    uploads.make_room(picture->rgba.size());  // if this fails, the failure belongs to earlier uploads
    return or_white(image, account, [&] {
        return account.textures.add<Image>(key, upload_texture(uploads, "image '" + image.name + "'", *picture,
                                                               is_color ? kColorTexture : kNumberTexture));
    });
}

std::shared_ptr<const raster::OwnedTexture> make_native_texture(Gpu& gpu, const AssetImage& image, bool is_color,
                                                                TextureAccount& account) {
    return or_white(image, account, [&] {
        take_room(image, account.room_bytes);
        const auto make = [&] {
            return raster::OwnedTexture(*decoded_picture(gpu, image),
                                        is_color ? raster::TexelKind::kColor : raster::TexelKind::kNumbers);
        };
        return account.textures.get<raster::OwnedTexture>(texture_key(SharedValue::kNativeTexture, image, is_color),
                                                          make);
    });
}

std::shared_ptr<const Image> make_white_texture(Uploads& uploads, SharedValues& textures) {
    const SharedValues::Key of_no_image{static_cast<uint64_t>(SharedValue::kTexture)};
    if (auto found = textures.find<Image>(of_no_image)) return found;
    return textures.add<Image>(
        of_no_image, upload_texture(uploads, "white texture", {.width = 1, .height = 1, .rgba = {255, 255, 255, 255}},
                                    kColorTexture));
}

}  // namespace throng
