// Exact keys -> packed ones (throng/character.h has the layout).
#pragma once

#include "base/progress.h"
#include "compile/clip/exact_clip.h"

#include <memory>
#include <span>
#include <string>

namespace throng {

// Throws kInvalidArgument where a bound is neither 0 nor within 1e-6..0.1.
void check_error_bound(double error, const std::string& place);

// Packs clips on threads of its own, beside other work of the thread that made it.
//
// Fills times_s, words, keys, root_rows and tracks of the character, completes its clips, and may add warnings. The
// mesh, the facts of all clips and the morph tracks must be there before. Until
// finish() has returned, nothing else may use these, or change the rig, the name or the size. `error`: largest
// displacement of a skinned point, as a part of the character's size; if a clip cannot keep it, its keys are nearly the
// finest possible, and the character gets a warning. Based on: Nicholas Frechette, Animation Compression Library (ACL),
// 2017: error measured at the skin, range reduction, bits per track found by measuring. Different: the bits come from
// sensitivities and one scale per clip, not from trying them track by track; each joint aims at its exact place from
// its packed parent, so that errors do not add up along chains; rows are left out by the same measure.
class ClipPacking {
public:
    // Begins. Keeps the references. Throws kLimit where there are too many rows; all else is thrown by finish().
    ClipPacking(std::span<const ExactClip> clips, double error, Character& character, const Progress& progress);
    ~ClipPacking();  // without finish(): waits for the clips that are being packed, and begins no more
    ClipPacking(const ClipPacking&) = delete;
    ClipPacking& operator=(const ClipPacking&) = delete;

    // Packs on this thread too until all is done.
    void finish();

private:
    class Work;
    std::unique_ptr<Work> work_;
};

}  // namespace throng
