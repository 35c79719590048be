// The definition of the controller stage (docs/controller.md): one instance, on the CPU, without any optimization.
// Values that decide a state are computed in float exactly as the definition says, and a device must agree bit for bit.
// Values that decide nothing are computed in double.
#pragma once

#include "control/root_motion_reference.h"
#include "controller/controller_arrays.h"
#include "controller/controller_tables.h"

#include <span>
#include <vector>

namespace throng {

// One clip as part of the instance's pose.
struct ControllerActiveClip {
    uint32_t clip = 0;  // clip_count: the rest pose
    uint32_t phase = 0;
    double time_s = 0;
    float weight = 1;        // within its layer
    uint32_t layer = kNone;  // kNone: the rest pose below all layers
    float layer_weight = 1;
    uint32_t mode = io::kModeOverride;
    uint32_t mask = kNone;
    bool model_rotations = false;  // override layers: rotations are blended in model space
};

struct ControllerEventAt {
    uint32_t event;  // index into Controller::events
    uint32_t layer;
    double time_s;  // 0..|time step|
};

constexpr size_t kMaxEvents = 16'384;  // the default of CrowdSettings::event_capacity

struct ControllerUpdate {
    std::vector<ControllerActiveClip> active_clips;  // lowest layer first; at least one
    // Layer by layer, and by time within a layer. At most kMaxEvents, so that a clip that loops a billion times in one
    // update does not take memory without bound
    std::vector<ControllerEventAt> events;
    GroundMove move;       // in model space before the update
    float inertial_s = 0;  // duration of the inertial transition that begins; 0: none does
};

class ControllerReference {
public:
    // Throws what check_controller() finds. Keeps references to both.
    ControllerReference(const Controller& controller, const Character& character);

    void apply(const io::ControlCommand& command);
    ControllerUpdate update(float time_step_s);

    // As the kernel keeps them, bit for bit, except for plays that have been dropped.
    std::vector<float> parameters;
    std::vector<io::LayerState> layers;

private:
    const Character& character_;
    ControllerArrays arrays_;
};

// The active clips of an instance as the sample and blend stages read them.
std::vector<io::ActiveClip> to_io(std::span<const ControllerActiveClip> active_clips, const Character& character);

}  // namespace throng
