// What comes back from updates to the CPU.
#pragma once

#include <throng/character.h>

#include <cstdint>
#include <vector>

namespace throng {

// An event of a controller's clip that an instance passed.
struct CharacterEvent {
    uint32_t instance = 0;
    uint32_t event = 0;  // index into Controller::events
    uint32_t layer = 0;
    float time_s = 0;         // after the beginning of the update's time step
    uint32_t generation = 0;  // InstanceHandle's
};

// What a layer plays: a state, or of a layer without states a clip.
struct PlayedMotion {
    uint32_t motion = kNone;  // index of ControllerLayer::states, or of Character::clips; kNone: the rest pose
    float phase = 0;          // of its cycle, 0..1
    uint32_t loops = 0;       // whole cycles since it was entered
    // How far it has replaced the one behind it, 0..1, linear in time (docs/controller.md, step 5)
    float fade = 1;

    bool operator==(const PlayedMotion&) const = default;
};

// A watched instance as it is after an update.
struct WatchedInstance {
    uint32_t instance = 0;
    uint32_t generation = 0;    // InstanceHandle's
    Affine world_from_model{};  // with all root motion so far, where it moves placements
    // Root motion of this update, in the character's space before it; the identity where there is none
    Affine move{};
    std::vector<Affine> sockets{};    // [socket_count] of its group, in its CrowdGroup::socket_space
    std::vector<float> parameters{};  // [parameter_count] of its controller
    // [layer_count] of its controller; of each, newest first, what it cross-fades: the first leads
    std::vector<std::vector<PlayedMotion>> layers{};
};

// What came back from one update.
struct Feedback {
    uint64_t update = 0;                     // counted from 1
    std::vector<CharacterEvent> events{};    // by instance, then layer, then time
    uint64_t lost_event_count = 0;           // that found no room
    std::vector<WatchedInstance> watched{};  // of watch(), in its order
};

}  // namespace throng
