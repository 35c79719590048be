// The definition of every stage: scalar, double precision, on the CPU, no Vulkan. The kernels are tested against it; a
// program can use it for the exact pose of one character at once (hit tests, servers). Characters must be as
// character.h says; unlike Crowd::create(), nothing here checks one that an application has edited.
#pragma once

#include <throng/character.h>
#include <throng/controller.h>
#include <throng/feedback.h>
#include <throng/playback.h>
#include <throng/procedural.h>

#include <memory>
#include <span>
#include <vector>

namespace throng {

struct ReferencePose {
    std::vector<AffineT<double>> parent_from_joint{};  // [joint_count]
    std::vector<AffineT<double>> model_from_joint{};   // [joint_count]
    std::vector<AffineT<double>> model_from_bind{};    // [palette_count], the skin matrices
    // [morph_count]; as a crowd without CrowdGroup::morph_limit shows them
    std::vector<double> morph_weights{};
};

// The pose that `playback` shows at its times (speeds do not matter). Errors: kInvalidArgument, as Crowd::set_playback.
Result<ReferencePose> reference_pose(const Character& character, const Playback& playback);

// One character with a controller on the CPU. Given the same parameters, commands and time steps as an instance of a
// Crowd it is in the same states at the same times, bit for bit (docs/controller.md), so a server that has no GPU knows
// what the clients see. Not thread-safe. One that has been moved from may only be assigned to or destroyed.
class ReferenceCharacter {
public:
    // The result refers to all arguments, which must live as long as it does; `rules` is as CrowdGroup::procedural.
    // Errors: as check_controller(), and as Crowd::create() for the rules.
    static Result<ReferenceCharacter> create(const Character& character, const Controller& controller,
                                             const ProceduralRules* rules = nullptr);
    ReferenceCharacter(ReferenceCharacter&&) noexcept;
    ReferenceCharacter& operator=(ReferenceCharacter&&) noexcept;
    ~ReferenceCharacter();

    // As Crowd's functions of these names, for this character.
    Result<void> play(LayerIndex layer, const LayerPlayback& playback);
    Result<void> set_state(LayerIndex layer, const PlayedMotion& motion, float fade_s = 0);
    Result<void> set_layer(LayerIndex layer, const LayerBlend& blend);
    Result<void> set_parameter(ParameterIndex parameter, float value);
    Result<void> set_pose(std::span<const Trs<float>> parent_from_joint, float fade_s = 0);
    Result<void> clear_pose(float fade_s = 0);
    Result<void> set_target(TargetIndex target, const TargetPlace& place);
    Result<void> set_wind(const Wind& wind);
    Result<void> update(float time_step_s);

    // Sets where it stands, which procedural rules depend on; update() moves it on by root motion if `moves` is set (as
    // CrowdGroup::moves_placements). `instance` is its number in the crowd, on which the phase of its sway in the wind
    // depends.
    void set_placement(const Affine& world_from_model, bool moves = true, uint32_t instance = 0);
    AffineT<double> placement() const;

    // After the last update (before the first: the rest pose).
    ReferencePose pose() const;
    // What happened in the last update; the instance of these events is 0, and only the first 16,384 are kept. An
    // instance of a crowd has the same events, except for the last digits of their times, and the order of events at
    // the same place of a clip.
    // `move` is root motion: world_from_model * move is where a character that stood at world_from_model stands now.
    std::span<const CharacterEvent> events() const;
    AffineT<double> move() const;
    std::span<const float> parameters() const;
    // As WatchedInstance::layers.
    std::vector<std::vector<PlayedMotion>> layers() const;

private:
    struct State;
    explicit ReferenceCharacter(std::unique_ptr<State> state);
    std::unique_ptr<State> state_;
};

// Positions of all vertices, morphed and skinned, in model space, in the order of Character::vertices.
std::vector<Vec3<double>> reference_positions(const Character& character, const ReferencePose& pose);

}  // namespace throng
