// Encoded images of characters, which groups keep for renderers; groups with the same images share them.
#pragma once

#include "gpu/gpu.h"

#include <throng/asset.h>

#include <memory>
#include <vector>

namespace throng {

using SharedImages = std::vector<std::shared_ptr<const AssetImage>>;

// A key for what is made from this image; callers append what else it depends on.
SharedValues::Key image_key(SharedValue kind, const AssetImage& image);

// The shared images; copies only those that no group of the device has yet.
SharedImages shared_images(Gpu& gpu, const std::vector<AssetImage>& images);

}  // namespace throng
