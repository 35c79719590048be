// The crowd that is shown: the characters of the files, how they stand, and what each one plays. That is also kept on
// the CPU, for the inspector.
#pragma once

#include "tools/scene/director.h"
#include "tools/scene/looks.h"
#include "tools/scene/scatter.h"
#include "tools/view/pick.h"

#include <throng/throng.h>

#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace throng::view {

// What comes from files.
struct Cast {
    std::vector<Character> characters;                   // not empty
    std::vector<std::optional<Controller>> controllers;  // [characters]
    std::vector<std::optional<tools::Looks>> looks;      // [characters]
    std::vector<uint32_t> shares;                        // [characters], of the whole number
    std::vector<double> heights;                         // as ScatterSettings has them

    // The same number of each, without controllers, all of one size.
    explicit Cast(std::vector<Character> of)
        : characters(std::move(of)),
          controllers(characters.size()),
          looks(characters.size()),
          shares(characters.size(), 1) {}
};

// A change of any of these makes a new crowd.
struct SceneSettings {
    uint32_t count = 100;
    uint64_t seed = 1;
    tools::Formation formation = tools::Formation::kGrid;
    float spacing = 1;
    std::string scan = "auto";
    UpdatePath path = UpdatePath::kAuto;
    SkinFormat format = SkinFormat::kAffine;
    SkinBlend blend = SkinBlend::kLinear;
    bool skins_once = false;
    bool culls = true;           // also switches levels of detail
    bool skips_updates = false;  // of what is small on the screen; needs culls, excludes keeps_joints
    bool keeps_joints = false;   // keeps the joints' matrices, from which skeletons are drawn

    bool operator==(const SceneSettings&) const = default;
};
inline constexpr uint32_t kMaxCharacters = 100'000;

// What all characters of a file without a controller play.
struct GroupPlayback {
    // Each character has its own clips and weights, by the seed; otherwise all have those below, each at its own time
    bool own = true;
    ClipIndex first = 0, second = 0;
    float weight = 1;

    bool operator==(const GroupPlayback&) const = default;
};

class Scene {
public:
    // Throws a CommandError if such a crowd cannot be made. The next four functions do so too, and leave the scene as
    // it was. If the old crowd cannot be made again either, there is none, and they throw a std::runtime_error. The
    // device must be idle.
    Scene(const Device& device, Cast cast, const SceneSettings& settings);
    void set_settings(const SceneSettings& settings);
    // Other characters.
    void set_cast(Cast cast);
    // [characters]; characters without a new controller keep the one they have. Clips that were chosen stay. So do
    // parameters that were set for all characters of a group, if its controller stays; those of single characters are
    // lost.
    void set_controllers(std::vector<std::optional<Controller>> controllers);
    void set_looks(std::vector<std::optional<tools::Looks>> looks);

    const Cast& cast() const { return *shown_.cast; }
    const SceneSettings& settings() const { return shown_.settings; }
    Crowd& crowd() { return *crowd_; }
    const Bounds& bounds() const { return bounds_; }  // of the rest poses and of clips, world space

    // Call before an update by this time step.
    void advance(float time_step_s);

    uint32_t group_of(uint32_t instance) const;
    // An instance by its group. This stays the same when the number of all instances changes.
    struct InGroup {
        uint32_t group = 0, number = 0;
    };
    InGroup place_of(uint32_t instance) const;
    std::optional<uint32_t> instance_at(const InGroup& place) const;  // none: the group has fewer
    uint32_t instance_count_of(uint32_t group) const { return shown_.field.groups[group].instance_count; }
    const Controller* controller_of(uint32_t group) const {
        return cast().controllers[group] ? &*cast().controllers[group] : nullptr;
    }

    // For groups without a controller.
    const GroupPlayback& group_playback(uint32_t group) const { return shown_.playback[group]; }
    void set_group_playback(uint32_t group, const GroupPlayback& playback);
    Playback playback_of(uint32_t instance) const;  // as it is now: times have moved on
    void set_playback_of(uint32_t instance, const Playback& playback);

    // Whether the director sets parameters of characters with controllers now and then. Without it they keep their last
    // values.
    bool directs() const { return directs_; }
    void set_directs(bool directs) { directs_ = directs; }
    // The values last set for all characters of a group with a controller; at first the controller's own.
    const std::vector<float>& parameters(uint32_t group) const { return shown_.parameters[group]; }
    // For all characters of the group, or for one.
    void set_parameter(uint32_t group, uint32_t parameter, float value);
    void set_parameter_of(uint32_t instance, uint32_t parameter, float value);

    // In the rest pose.
    PlacedBox box_of(uint32_t instance) const;
    std::optional<uint32_t> pick(const Projection::Ray& ray) const;

private:
    struct Playing {
        Playback from;       // what it played at since_s
        double since_s = 0;  // of the clock
    };
    struct Shown {
        std::shared_ptr<const Cast> cast;
        SceneSettings settings;
        std::vector<GroupPlayback> playback;         // [characters]
        std::vector<std::vector<float>> parameters;  // [characters][parameters of its controller]
        // What make_field() and begin_playing() make of the above
        tools::Scatter field{};
        std::vector<Playing> playing{};  // [instances]

        Shown(Cast of, const SceneSettings& made_so);
    };

    void rebuild(Shown wanted);
    void make_field();
    void begin_playing();
    void make_crowd();
    uint32_t first_instance_of(uint32_t group) const;
    Playback chosen(uint32_t group, uint32_t instance) const;
    void send_playback(uint32_t group);

    Device device_;
    Shown shown_;
    std::optional<Crowd> crowd_;
    std::optional<tools::Director> director_;
    Bounds bounds_;
    double clock_s_ = 0;
    bool directs_ = true;
};

}  // namespace throng::view
