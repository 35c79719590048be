// What a camera sees of a crowd.
#pragma once

#include <throng/device.h>
#include <throng/transform.h>

#include <array>
#include <cstdint>

namespace throng {

// What a camera sees: in crowds that cull (CrowdSettings::culling), an update for a view animates only what the view
// shows, and lists it for drawing. For several cameras, give one that sees what all of them do, and choose from the
// list for each.
struct CrowdView {
    // [row][column]. A world point p is seen if -w <= x, y <= w and 0 <= z <= w, where (x, y, z, w) is this matrix
    // times (p, 1)
    std::array<std::array<float, 4>, 4> clip_from_world{};
    Vec3<float> eye{};  // world space
    // How many pixels a length of 1 takes at a distance of 1: the picture's height / (2 tan(half the vertical field of
    // view))
    float pixels = 1000;
    // A coarser level of detail is drawn if its surfaces lie within this many pixels of the finest one's in the rest
    // pose and in clips (Lod::error). That holds in the middle of the picture; towards the edges, perspective stretches
    // it
    float lod_pixels = 1;
    // How far a character's shadow reaches, world space: a character outside the view whose shadow falls into it is
    // drawn too
    Vec3<float> shadow{};
    float ground = -1e30f;  // world y; nothing below it is seen, so shadows end there
    // With Culling::skips_updates: a character whose box is at least this many pixels across is animated in every
    // update, one of half as many in every second, of a quarter in every fourth, a smaller one in every eighth; 0: all
    // in every update.
    float full_rate_pixels = 0;  // at most 1e30
    // With Culling::skips_updates: time that the update of the whole crowd may take (StageTimes::total()), in
    // milliseconds. While it takes longer, full_rate_pixels (at least 1) is raised from update to update, and lowered
    // again, not below what is set here, when there is time to spare. 0: no limit. Needs timestamps.
    float budget_ms = 0;
    // Leaves out characters hidden behind others too: record() animates and lists only those that were visible in the
    // last update, and record_disoccluded() adds the others that are visible.
    bool occlusion = false;
    // With CrowdGroup::skin_pool: a character may show a shared pose that displaces it by at most this many pixels, as
    // measured for lod_pixels; 0: only when the pool is full.
    float shared_pose_pixels = 1;
};

// Depths of what the crowd's last record() has listed, and of anything else that hides characters, as drawn with
// CrowdView::clip_from_world: an image of one sample and one 32-bit float a texel (VK_FORMAT_D32_SFLOAT or
// VK_FORMAT_R32_SFLOAT), in VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL, with that usage. If the depths were drawn with
// several samples, each texel holds the farthest of them.
struct DepthImage {
    VkImage image = VK_NULL_HANDLE;
    VkImageAspectFlags aspect = VK_IMAGE_ASPECT_DEPTH_BIT;
    uint32_t width = 0, height = 0;
    bool reversed = true;  // nearer is greater
};

// An instance that is drawn, its level of detail (0 is the finest), and which row of OutputBlock::skin it has:
// its number in the block or, with a skin pool, a shared pose's or one of its own.
struct DrawnInstance {
    uint32_t instance = 0, lod = 0, skin_row = 0;
    bool shares_pose = false;
};

}  // namespace throng
