#include "base/failure.h"
#include "draw/native_group.h"

#include <throng/draw.h>

#include <algorithm>
#include <memory>
#include <optional>

namespace throng {
namespace {

// Shaders draw from decoded pictures, the native renderer from its own textures. On a software device either may draw,
// so both are made.
struct Decoded {
    std::optional<TexturedMaterials<Picture>> pictures;
    std::optional<TexturedMaterials<raster::OwnedTexture>> textures;
};

// Drops warnings: renderers try again to decode what could not be decoded, and warn then.
std::shared_ptr<const Decoded> decoded_of(Gpu& gpu, const Group& group, uint64_t& room_bytes) {
    std::vector<std::string> warnings;
    auto decoded = std::make_shared<Decoded>();
    uint64_t room_of_pictures_bytes = room_bytes;
    TextureAccount account{warnings, room_of_pictures_bytes, gpu.values};
    if (!gpu.is_native())
        decoded->pictures.emplace(group,
                                  [&](const AssetImage& image, bool) { return decode_or_none(gpu, image, account); });
    if (gpu.processor) decoded->textures.emplace(native_materials(gpu, group, warnings, room_bytes));
    room_bytes = std::min(room_bytes, room_of_pictures_bytes);
    return decoded;
}

}  // namespace

Result<void> decode_images(const Crowd& crowd) {
    return as_result(
        [&] {
            const CrowdState& state = crowd.state();
            uint64_t room_bytes = kTexturesLimit_bytes;
            for (const Group& group : state.groups)
                if (!group.is_gone()) group.life->decoded = decoded_of(*state.gpu, group, room_bytes);
        },
        "images");
}

}  // namespace throng
