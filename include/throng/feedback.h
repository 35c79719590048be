// What comes back from updates to the CPU.
#pragma once

#include <throng/index.h>
#include <throng/population.h>
#include <throng/transform.h>

#include <cstdint>
#include <span>
#include <vector>

namespace throng {

// An event of a controller's clip that an instance passed.
struct CharacterEvent {
    InstanceHandle instance;
    EventIndex event = 0;  // index into Controller::events
    LayerIndex layer = 0;
    float time_s = 0;  // after the beginning of the update's time step
};

// What a layer plays: a state or, in a layer without states, a clip.
struct PlayedMotion {
    uint32_t motion = kNone;  // index of ControllerLayer::states, or of Character::clips; kNone: the rest pose
    float phase = 0;          // of its cycle, 0..1
    uint32_t loops = 0;       // whole cycles since it was entered
    // How far it has replaced the next, older motion of its layer, 0..1, linear in time (docs/controller.md, step 5)
    float fade = 1;
    // For a clip, the values that play() was given. For a state, always 1 and true: its ControllerState has its own.
    // set_state() ignores both, and `fade` too
    float speed = 1;
    bool loop = true;

    bool operator==(const PlayedMotion&) const = default;
};

// A watched instance as it is after an update. Its spans refer to the Feedback that contains it, and are valid as long
// as that exists.
struct WatchedInstance {
    InstanceHandle instance;
    Affine world_from_model{};  // with all root motion so far, where it moves placements
    // Root motion of this update, in the character's space before it; the identity where there is none
    Affine move{};
    std::span<const Affine> sockets{};    // [socket_count] of its group, in its CrowdGroup::socket_space
    std::span<const float> parameters{};  // [parameter_count] of its controller
    // [layer_count] of its controller; for each layer what it cross-fades, newest first: the first leads
    std::span<const std::span<const PlayedMotion>> layers{};
    // [layer_count]: the current weight, from ControllerLayer::weight or set_layer(); during a fade, how far it has
    // changed. A layer's weight_parameter multiplies it. Not reported, so a game must remember them: the mode and mask
    // given to set_layer(), and the durations of fades under way
    std::span<const float> layer_weights{};
};

// The pose that an instance showed after an update. Its span is valid as long as the Feedback that contains it.
struct ShownPose {
    InstanceHandle instance;
    std::span<const Trs<float>> parent_from_joint{};  // [joint_count], as Crowd::set_pose() takes it
};

// What came back from one update. Can be moved (what refers to it stays valid), but not copied.
struct Feedback {
    uint64_t update = 0;                     // counted from 1
    std::vector<CharacterEvent> events{};    // by instance, then layer, then time
    uint64_t lost_event_count = 0;           // events beyond event_capacity; exact below 2^32 events an update
    std::vector<WatchedInstance> watched{};  // of watch(), in its order
    std::vector<ShownPose> poses{};          // of request_poses(), in the order of the calls

    // Internal: what `watched` and `poses` refer to.
    struct Arrays {
        Arrays() = default;
        Arrays(Arrays&&) = default;
        Arrays& operator=(Arrays&&) = default;

        std::vector<Affine> sockets;
        std::vector<float> parameters;
        std::vector<PlayedMotion> motions;
        std::vector<std::span<const PlayedMotion>> layers;
        std::vector<float> layer_weights;
        std::vector<Trs<float>> joints;
    };
    Arrays arrays{};
};

}  // namespace throng
