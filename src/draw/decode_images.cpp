#include "base/failure.h"
#include "draw/native_group.h"

#include <throng/draw.h>

namespace throng {
namespace {

using Pictures = TexturedMaterials<Picture>;
using NativeTextures = TexturedMaterials<raster::OwnedTexture>;

// What the renderer warns of when it draws is left to it.
std::shared_ptr<const void> decoded_of(Gpu& gpu, const Group& group, uint64_t& room_bytes) {
    std::vector<std::string> warnings;
    if (gpu.native) return std::make_shared<const NativeTextures>(native_materials(gpu, group, warnings, room_bytes));
    TextureAccount account{warnings, room_bytes, gpu.values};
    return std::make_shared<const Pictures>(
        group, [&](const AssetImage& image, bool) { return decode_or_none(gpu, image, account); });
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
