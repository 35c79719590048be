// How instances look, by the shaders' own text.
#pragma once

#include "crowd/batch.h"
#include "gpu/native_kernel.h"

#include <optional>

namespace throng {

class NativeLooks {
public:
    NativeLooks(const Group& group, const Batch& batch) : section_count_(static_cast<uint32_t>(group.sections.size())) {
        buffers_.buffers[io::kInstanceLooksBuffer] = batch[io::kInstanceLooksBuffer].mapped();
        buffers_.buffers[io::kSectionLooksBuffer] = group[io::kSectionLooksBuffer].mapped();
    }

    // Whether they differ.
    explicit operator bool() const { return buffers_.buffers[io::kInstanceLooksBuffer] != nullptr; }
    // What the base colour of a section is multiplied with; none where the instance does not show it.
    std::optional<Vec3<float>> color_of(uint32_t instance, uint32_t section) const;

private:
    uint32_t section_count_;
    NativeDispatch buffers_;
};

}  // namespace throng
