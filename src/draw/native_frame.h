// A picture of crowds by this machine's processor (src/raster).
#pragma once

#include "draw/crowd_bounds.h"
#include "draw/native_group.h"
#include "draw/native_list.h"
#include "draw/native_looks.h"
#include "draw/native_scratch.h"
#include "draw/native_vertices.h"
#include "native/native.h"

#include <throng/draw.h>

namespace throng {

// Milliseconds of the steps of the last picture, and what it drew.
struct NativeTimes {
    double list_ms = 0, skin_ms = 0, shadow_ms = 0, picture_ms = 0, resolve_ms = 0;
    uint64_t instances = 0, vertices = 0, triangles = 0;  // that were skinned
    double total_ms() const { return list_ms + skin_ms + shadow_ms + picture_ms + resolve_ms; }
};

using NativeGroups = std::vector<const NativeGroup*>;  // of a crowd: [group]

// Where a picture is written.
struct NativePixels {
    uint8_t* bytes;           // [height][width][4]
    bool blue_first = false;  // else red, green, blue, 255
};

// Draws pictures of one size, and keeps its memory from one to the next. Results do not depend on the number of
// threads.
class NativeFrame {
public:
    // `samples`: 1 or 4.
    NativeFrame(std::shared_ptr<Gpu> gpu, VkExtent2D extent, uint32_t samples, NativeIsa isa);

    const VkExtent2D& extent() const { return extent_; }
    uint32_t samples() const { return frame_.sample_count; }
    // `native`: of each crowd. No work may be under way on the queue that writes the crowds' buffers.
    void draw(Crowds crowds, std::span<const NativeGroups> native, const Camera& camera, const DrawOptions& options,
              const NativePixels& pixels);
    const NativeTimes& times() const { return times_; }

private:
    // An instance that is drawn.
    struct Posed {
        uint32_t batch = 0;  // of drawn_
        uint32_t lod = 0;
        uint32_t place = 0;  // in the batch's list, and so among the draws of each section
    };
    struct Drawn {  // a batch of a crowd
        const CrowdState* crowd = nullptr;
        const NativeGroup* native = nullptr;
        const Batch* batch = nullptr;
        uint32_t first_layer = 0;  // coverage_layer()'s number of the batch's first instance
        const Group& group() const { return crowd->groups[batch->group]; }
        const NativeMesh& mesh() const { return native->mesh(); }
        PosedInstance posed(uint32_t instance) const { return {group(), *batch, instance}; }

        NativeList list;
        std::vector<uint32_t> first_draws;  // [lod][section], of the list's first instance
    };
    struct Job {
        uint32_t first = 0, end = 0;  // of posed_
    };

    void set_drawn(Crowds crowds, std::span<const NativeGroups> native);
    void list(const DrawOptions& options);
    void add_draws(uint32_t batch, uint64_t& next_id);
    void give_ids(uint64_t id_count);
    void give_memory();
    void divide();
    void add_lines(const DrawOptions& options);
    static void set_look(const NativeGroup& group, const NativeLook& look, raster::Draw& draw);
    void skin();
    void skin_instance(const Posed& posed, NativeScratch& scratch);
    void sort_by_distance();
    // `are_clear`: [tile], whether the last picture left the tile clear; true at first.
    template <class Draw>
    void draw_tiles(VkExtent2D of, VkExtent2D largest, std::vector<uint8_t>& are_clear, const Draw& draw);
    void resolve();

    std::shared_ptr<Gpu> gpu_;
    VkExtent2D extent_;
    const raster::Kernel& kernel_;
    NativeMemory map_, samples_, vertices_;
    uint64_t vertices_bytes_ = 0;                           // of vertices_
    std::vector<uint8_t> map_is_clear_, picture_is_clear_;  // [tile]
    std::vector<uint32_t> srgb_;
    NativeScratchPool scratch_;

    io::DrawScene scene_{};
    raster::Frame frame_;
    std::vector<Drawn> drawn_;  // all batches of all crowds
    std::vector<Posed> posed_;
    std::vector<Job> jobs_;
    std::vector<raster::Draw> draws_;
    std::vector<uint64_t> distances_;  // sort keys: the complement of `nearest`, then the number of the draw
    std::vector<uint32_t> nearest_first_, draw_of_ids_;
    std::vector<raster::Line> lines_;
    std::vector<uint32_t> casters_;
    NativeTimes times_;
};

}  // namespace throng
