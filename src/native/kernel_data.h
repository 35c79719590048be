// What the kernels of all instruction sets read: plain numbers and pointers, so that no function of a header is
// compiled for an instruction set that a machine may not have.
#pragma once

#include <cstddef>
#include <cstdint>

namespace throng::native {

inline constexpr uint32_t kBlockJoints = 16;    // joints of a block, whose rows lie together
inline constexpr uint32_t kInertiaFloats = 14;  // of state for each place of a joint, kept between updates
inline constexpr uint32_t kNoIndex = 0xFFFFFFFFu;

// The rows between two keys of a clip, evenly spaced.
struct RowSpan {
    uint32_t first_row = 0;
    float piece_count = 1;  // row first_row + piece_count is the last
};

struct RowClip {
    const RowSpan* spans = nullptr;  // [rows of keys]
    uint32_t first_key = 0;          // in the unit of cursors (control_io.h): Clip::first_row
    double span_from_key = 0;        // 1 / Clip::row_stride
};

// Four components of 16 joints, at the same offset in each row. As 16-bit words: x of four joints, then their y, x of
// the next four, …; then z and w in the same order. So interleaving the words of two rows gives pairs of one component.
// As floats: 16 x, 16 y, ….
struct RowBlock {
    uint32_t offset = 0;  // bytes, from where a row begins
    bool is_float = false;
};

// Special values of WalkStep::parent and Emission::source, which otherwise are slots. kLast: the matrix of the joint
// walked last.
inline constexpr uint32_t kRoot = 0;  // slot 0 has the identity
inline constexpr uint32_t kLast = kNoIndex;

// A joint of the walk: L' = linear * (p - pivot) + centre, in the spaces that its rows have been brought into
// (native_rig.h).
struct WalkStep {
    float centre[3] = {}, pivot[3] = {}, scale[3] = {1, 1, 1};  // centre and scale: if no rows have them
    uint32_t parent = kLast, keep = kNoIndex;                   // slots: its parent's matrix, and where to keep its own
    uint32_t motion = kNoIndex;                                 // place among the joints with rows of motion
    uint32_t scales = kNoIndex;                                 // place among the joints with rows of three scales
    uint32_t emission_count = 0;
};

enum class EmissionKind : uint32_t { kSkin, kSkinAt, kModel, kSocket };

// A matrix that is written: source * constants[constant].
struct Emission {
    EmissionKind kind = EmissionKind::kSkin;
    uint32_t source = kLast;
    uint32_t constant = kNoIndex;
    uint32_t target = 0;  // palette entry, joint of the rig, or socket; for kSkin, the next entry
};

struct KernelRig {
    const std::byte* rows = nullptr;
    size_t row_bytes = 0;
    bool prefetches = false;  // the rows of all clips exceed a core's second-level cache
    const RowClip* clips = nullptr;
    double clip_from_track = 0;  // 1 / joints of the rig
    // Blocks of rotations, of motions (translation, with the scale if it is uniform), of three scales
    const RowBlock* blocks = nullptr;
    const float* ranges = nullptr;  // [block][8][16]: middles of four components, then their steps
    uint32_t joint_count = 0;       // joints that are walked
    uint32_t motion_count = 0, scales_count = 0;
    bool three_scales = false;
    const WalkStep* steps = nullptr;
    const Emission* emissions = nullptr;
    const float* constants = nullptr;  // [constant][12]
    uint32_t slot_count = 1;
    uint32_t place_count = 0;  // of joints in all blocks
    uint32_t mask_stride = 0;  // floats of a mask: one a place, then the largest of each block
    uint32_t rig_joint_count = 0, palette_count = 0, socket_count = 0;
};

}  // namespace throng::native
