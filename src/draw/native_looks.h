// How instances look, computed by the shaders' own source.
#pragma once

#include "crowd/batch.h"
#include "gpu/native_kernel.h"

namespace throng {

// How an instance shows a section.
struct NativeLook {
    uint32_t material;  // io::SectionLook's
    Vec3<float> color;  // multiplies the base colour
};

class NativeLooks {
public:
    NativeLooks(const Group& group, const Batch& batch) : section_count_(static_cast<uint32_t>(group.sections.size())) {
        buffers_.buffers[io::kInstanceLooksBuffer] = batch[io::kInstanceLooksBuffer].mapped();
        buffers_.buffers[io::kSectionLooksBuffer] = group[io::kSectionLooksBuffer].mapped();
    }

    // Whether instances look different.
    explicit operator bool() const { return buffers_.buffers[io::kInstanceLooksBuffer] != nullptr; }
    NativeLook of(uint32_t instance, uint32_t section) const;

private:
    uint32_t section_count_;
    NativeDispatch buffers_;
};

}  // namespace throng
