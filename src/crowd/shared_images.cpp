#include "crowd/shared_images.h"

#include "gpu/shared_buffers.h"

#include <functional>

namespace throng {

SharedValues::Key image_key(SharedValue kind, const AssetImage& image) {
    const auto [crc, hash, size_bytes, usage, texel_bytes] = SharedBuffers::key_of(image.encoded, 0, 0);
    return {uint64_t(kind), crc, hash, size_bytes};
}

SharedImages shared_images(Gpu& gpu, const std::vector<AssetImage>& images) {
    SharedImages shared;
    for (const AssetImage& image : images) {
        SharedValues::Key key = image_key(SharedValue::kImage, image);
        key.push_back(std::hash<std::string>()(image.name));  // warnings name the image
        shared.push_back(gpu.values.get<AssetImage>(key, [&] { return image; }));
    }
    return shared;
}

}  // namespace throng
