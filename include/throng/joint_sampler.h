// Where chosen joints of a character are at any time: hit boxes, muzzles, the feet of a pose to come.
#pragma once

#include <throng/character.h>
#include <throng/playback.h>

#include <memory>
#include <span>
#include <vector>

namespace throng {

class NativeJoints;  // internal

// Computes chosen joints and the joints above them, nothing else, on this machine's processor. A handle: copies share
// the same data, and any number of threads can use it at a time. Keeps no reference to the character.
class JointSampler {
public:
    // Reads the clips' keys of all these joints, which takes milliseconds, tens of them for large characters: create
    // one sampler for each character, not one for each query. Errors: kInvalidArgument (no joints, or one that is out
    // of range), kUnsupported (a processor without a native engine).
    static Result<JointSampler> create(const Character& character, std::span<const uint32_t> joints);

    // model_from_joint, in the order of the joints, of a character that plays this at the times given; within 1e-5 of
    // its size. Allocates nothing after a thread's first call. Errors: kInvalidArgument (clip out of range, value not
    // finite, weight outside 0..1, results and joints differ in number).
    Result<void> sample(const Playback& playback, std::span<Affine> model_from_joint) const;

    // Internal.
    explicit JointSampler(std::shared_ptr<const NativeJoints> joints);

private:
    std::shared_ptr<const NativeJoints> joints_;
};

}  // namespace throng
