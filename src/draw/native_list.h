// Which instances of a crowd the native renderer draws, and in how much detail.
#pragma once

#include "crowd/crowd_state.h"
#include "draw/draw_io.h"

#include <array>
#include <vector>

namespace throng {

// Instances of a batch to draw, in the order in which the device draws them.
struct NativeList {
    std::vector<uint32_t> instances;                   // of the batch, finest level of detail first
    std::array<uint32_t, io::kLodCount + 1> begins{};  // of the levels, and their end
};

// Lists the instances that the crowd's culling has listed; if it does not cull, all instances, in the finest level.
void list_instances(const Batch& batch, NativeList& list);

// The part of space that the picture or, with shadows, the shadow map shows.
class NativeView {
public:
    NativeView(const io::DrawScene& scene, bool shadows);

    // Removes instances whose posed bounds lie outside of both.
    void keep_seen(const Group& group, const Batch& batch, const NativeDevice& device, NativeList& list);

private:
    bool shows(const Affine& world_from_model, const Vec3<float>& centre, const Vec3<float>& half_extent) const;

    std::vector<io::vec4> picture_, map_;  // a point p is inside if dot(xyz, p) + w >= 0 for all of them
    bool shadows_;
    std::vector<uint8_t> seen_;  // [place in the list]
};

}  // namespace throng
