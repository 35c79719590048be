#include <throng/crowd.h>

#include "base/failure.h"
#include "crowd/crowd_state.h"
#include "crowd/path.h"
#include "reference/reference.h"

namespace throng {

Result<ScanAdvice> advise_scan(const Device& device, const Rig& rig, uint32_t instance_count) {
    return as_result([&] {
        const Gpu& gpu = *device.gpu();
        if (rig.joint_count() == 0) throw Failure(ErrorCode::kInvalidArgument, "scan", "the rig has no joints");
        const ExplainedChoice chosen = choose_scan(gpu, "auto", rig, instance_count);
        return ScanAdvice{name_of(chosen.choice), chosen.reason};
    });
}

Result<GroupPath> advise_path(const Device& device, const Character& character, uint32_t instance_count) {
    return as_result([&] {
        check_has_joints(character);
        const PathChoice choice = choose_path(*device.gpu(), {},
                                              {.character = &character, .instance_count = instance_count});
        return GroupPath{
            choice.fused.has_value(), choice.native, choice.path_reason, {name_of(choice.scan), choice.scan_reason}};
    });
}

Result<Crowd> Crowd::create(const Device& device, const CrowdSettings& settings) {
    return as_result([&] { return Crowd(std::make_unique<CrowdState>(device.gpu(), settings)); }, "crowd");
}

Crowd::Crowd(std::unique_ptr<CrowdState> state) : state_(std::move(state)) {}
Crowd::Crowd(Crowd&&) noexcept = default;
Crowd& Crowd::operator=(Crowd&&) noexcept = default;
Crowd::~Crowd() = default;

CrowdState& Crowd::state() const {
    if (!state_) throw Failure(ErrorCode::kInvalidArgument, "crowd", "it has been moved from");
    return *state_;
}

uint32_t Crowd::instance_count() const { return state_ ? state_->instance_count : 0; }

Result<GroupPath> Crowd::path(uint32_t group) const {
    return as_result([&] {
        const Group& of = state().group_at(group);
        return GroupPath{!of.fused.empty(), of.native, of.path_reason, {name_of(of.scan_choice), of.scan_reason}};
    });
}

Result<std::vector<InstanceHandle>> Crowd::spawn(uint32_t group, std::span<const Affine> world_from_model) {
    return as_result([&] { return state().spawn(group, world_from_model); });
}

Result<void> Crowd::despawn(std::span<const InstanceHandle> instances) {
    return as_result([&] { state().despawn(instances); });
}

bool Crowd::is_alive(const InstanceHandle& instance) const { return state_ && state_->is_alive(instance); }

Result<InstanceHandle> Crowd::handle(uint32_t instance) const {
    return as_result([&] { return state().handle(instance); });
}

Result<uint32_t> Crowd::alive_count(uint32_t group) const {
    return as_result([&] { return state().alive_count(group); });
}

Result<void> Crowd::set_playback(uint32_t first_instance, std::span<const Playback> playback) {
    return as_result([&] { state().set_playback(first_instance, playback); });
}

Result<void> Crowd::set_placement(uint32_t first_instance, std::span<const Affine> world_from_model) {
    return as_result([&] { state().set_placement(first_instance, world_from_model); });
}

Result<void> Crowd::play(uint32_t instance, uint32_t layer, const LayerPlayback& playback) {
    return as_result([&] { state().play(instance, layer, playback); });
}

Result<void> Crowd::set_layer(uint32_t instance, uint32_t layer, const LayerBlend& blend) {
    return as_result([&] { state().set_layer(instance, layer, blend); });
}

Result<void> Crowd::set_parameters(uint32_t instance, uint32_t parameter, std::span<const float> values) {
    return as_result([&] { state().set_parameters(instance, parameter, values); });
}

Result<void> Crowd::set_target(uint32_t instance, uint32_t target, const Vec3<float>& world_place, float weight) {
    return as_result([&] { state().set_target(instance, target, world_place, weight); });
}

Result<void> Crowd::set_wind(const Wind& wind) {
    return as_result([&] { state().procedural->set_wind(wind); });
}

Result<void> Crowd::set_destination(uint32_t first_instance, std::span<const Vec3<float>> world_places) {
    return as_result([&] { state().set_destination(first_instance, world_places); });
}

Result<void> Crowd::clear_destination(uint32_t first_instance, uint32_t count) {
    return as_result([&] { state().clear_destination(first_instance, count); });
}

Result<void> Crowd::set_pose(uint32_t instance, std::span<const Trs<float>> parent_from_joint, float fade_s) {
    return as_result([&] { state().set_pose(instance, parent_from_joint, fade_s); });
}

Result<void> Crowd::clear_pose(uint32_t instance, float fade_s) {
    return as_result([&] { state().clear_pose(instance, fade_s); });
}

Result<void> Crowd::watch(std::span<const uint32_t> instances) {
    return as_result([&] { state().watch(instances); });
}

Result<std::vector<Feedback>> Crowd::feedback() {
    return as_result([&] { return state().take_feedback(); });
}

Result<void> Crowd::record(VkCommandBuffer commands, float time_step_s, const CrowdView* view) {
    return as_result(
        [&] {
            const bool is_native = state().gpu->is_native();
            if (is_native == (commands != VK_NULL_HANDLE))
                throw Failure(ErrorCode::kInvalidArgument, "command buffer",
                              is_native ? "a native device has none: call update()" : "there is none");
            state().record(commands, time_step_s, view);
        },
        "crowd");
}

Result<void> Crowd::record_disoccluded(VkCommandBuffer commands, const DepthImage& depths) {
    return as_result(
        [&] {
            if (!commands && !state().gpu->is_native())
                throw Failure(ErrorCode::kInvalidArgument, "command buffer", "there is none");
            state().record_disoccluded(commands, depths);
        },
        "crowd");
}

Result<void> Crowd::discard_last_record() {
    return as_result([&] { state().discard_last_record(); }, "crowd");
}

Result<void> Crowd::update(float time_step_s, const CrowdView* view) {
    return as_result([&] { state().update(time_step_s, view); }, "crowd");
}

Result<std::vector<DrawnInstance>> Crowd::read_drawn() {
    return as_result([&] { return state().read_drawn(); });
}

std::span<const OutputBlock> Crowd::outputs() const {
    return state_ ? std::span<const OutputBlock>(state_->outputs) : std::span<const OutputBlock>();
}

Result<StageTimes> Crowd::stage_times() const {
    return as_result([&] {
        if (!state().timer)
            throw Failure(ErrorCode::kInvalidArgument, "stage times", "timestamps are off, or the queue has none");
        return state().timer->read();
    });
}

Result<std::vector<Affine>> Crowd::read_skin_matrices(uint32_t instance) {
    return as_result([&] { return state().read_matrices(instance, false); });
}

Result<std::vector<Affine>> Crowd::read_model_matrices(uint32_t instance) {
    return as_result([&] { return state().read_matrices(instance, true); });
}

Result<std::vector<Vec3<float>>> Crowd::read_positions(uint32_t instance) {
    return as_result([&] { return state().read_positions(instance); });
}

uint64_t Crowd::size_bytes() const { return state_ ? state_->size_bytes() : 0; }

}  // namespace throng
