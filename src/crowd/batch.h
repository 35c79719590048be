// A run of a group's instances whose buffers fit the device's limits.
#pragma once

#include "crowd/group.h"
#include "gpu/kernel.h"

namespace throng {

struct Batch {
    uint32_t group = 0;
    uint32_t first_instance = 0, instance_count = 0;
    uint32_t blending_count = 0;  // instances in which both clips have weight, as last set
    bool blends = false;          // whether there are any in the update that is under way
    Buffers buffers;              // those that its settings ask for
    // Skin matrices; the second only where CrowdSettings::keep_previous_matrices, and then they take turns.
    std::array<Buffer, 2> skins;
    uint32_t current_skin = 0;  // written by the last update
    Bindings control;

    Buffer& operator[](uint32_t number) { return buffers[number]; }
    const Buffer& operator[](uint32_t number) const { return buffers[number]; }
    const Buffer& skin() const { return skins[current_skin]; }

    // What kernels find of the batch and its group. `absent` stands for storage buffers that they do not have.
    BufferTable table(const Group& of, const BufferRange& absent) const {
        return BufferTable()
            .add(of.buffers)
            .add(buffers)
            .set({{io::kLayersBeforeBuffer, buffers[io::kLayersBuffer]},
                  {io::kParametersBeforeBuffer, buffers[io::kParametersBuffer]}})
            .set_absent(absent, of[io::kWordsBuffer]);
    }
};

}  // namespace throng
