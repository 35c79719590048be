// Which clip, layer, parameter and so on a call is about: each kind of index is a type of its own, so that one cannot
// be given where another is meant.
#pragma once

#include <cstdint>

namespace throng {

inline constexpr uint32_t kNone = 0xFFFFFFFFu;  // "no index", wherever an index is optional

enum class Indexed { kGroup, kSocket, kClip, kState, kLayer, kParameter, kMask, kEvent, kTarget, kJoint };

// An index into one kind of list. Converts from and to a bare number, for applications that count or store such numbers
// themselves, but not to an index into another kind of list. In `condition ? index : kNone` write index.number. Plain
// numbers are: sections, materials, morphs, lists of joints (CrowdGroup::sockets, JointSampler::create()), and
// PlayedMotion::motion, which is a state or a clip.
template <Indexed>
struct Index {
    constexpr Index() = default;
    constexpr Index(uint32_t index) : number(index) {}
    constexpr operator uint32_t() const { return number; }

    uint32_t number = 0;
};
template <Indexed a, Indexed b>
requires(a != b) bool operator==(Index<a>, Index<b>) = delete;

using GroupIndex = Index<Indexed::kGroup>;    // of a crowd's groups: Crowd::groups()
using SocketIndex = Index<Indexed::kSocket>;  // into CrowdGroup::sockets
using ClipIndex = Index<Indexed::kClip>;      // into Character::clips
using StateIndex = Index<Indexed::kState>;    // into ControllerLayer::states
using LayerIndex = Index<Indexed::kLayer>;    // into the lists of a Controller, and so the following
using ParameterIndex = Index<Indexed::kParameter>;
using MaskIndex = Index<Indexed::kMask>;
using EventIndex = Index<Indexed::kEvent>;
using TargetIndex = Index<Indexed::kTarget>;  // into ProceduralRules::targets
using JointIndex = Index<Indexed::kJoint>;    // into the lists of a Rig

}  // namespace throng
