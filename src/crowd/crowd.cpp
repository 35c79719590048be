#include <throng/crowd.h>

#include "base/failure.h"
#include "base/message_name.h"
#include "compile/file/character_check.h"
#include "crowd/crowd_state.h"
#include "crowd/path.h"
#include "json/known_names.h"
#include "reference/reference.h"

namespace throng {
namespace {

// [sockets]. A socket that is not a joint of the group's character has a text that nobody looks for.
std::vector<std::string> socket_names(const CrowdGroup& group) {
    std::vector<std::string> names(group.sockets.size(), "(no joint)");
    if (!group.character) return names;
    const std::vector<std::string>& joints = group.character->rig.names;
    for (size_t i = 0; i < names.size(); ++i)
        if (group.sockets[i] < joints.size()) names[i] = joints[group.sockets[i]];
    return names;
}

}  // namespace

SocketIndex CrowdGroup::find_socket(std::string_view joint_name) const {
    return find_name(socket_names(*this), joint_name);
}
Result<SocketIndex> CrowdGroup::socket_named(std::string_view joint_name) const {
    return index_named<SocketIndex>(character ? character->name : "group", "socket", socket_names(*this), joint_name);
}

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
        check_character(character, message_name(character.name), ErrorCode::kInvalidArgument);
        const PathChoice choice = choose_path(*device.gpu(), {},
                                              {.character = &character, .instance_count = instance_count});
        return GroupPath{choice.fused.has_value(),
                         choice.native,
                         shown_reason(choice.native, choice.path_reason),
                         {name_of(choice.scan), choice.scan_reason}};
    });
}

Result<Crowd> Crowd::create(const Device& device, const CrowdSettings& settings) {
    return as_result([&] { return Crowd(std::make_unique<CrowdState>(device.gpu(), settings)); }, "crowd");
}

Crowd::Crowd(std::unique_ptr<CrowdState> state) : state_(std::move(state)) {}
Crowd::Crowd() noexcept = default;
Crowd::Crowd(Crowd&&) noexcept = default;
Crowd& Crowd::operator=(Crowd&&) noexcept = default;
Crowd::~Crowd() = default;

CrowdState& Crowd::state() const {
    if (!state_)
        throw Failure(ErrorCode::kInvalidArgument, "crowd",
                      "the Crowd was not made by Crowd::create(), or has been moved from");
    return *state_;
}

uint32_t Crowd::instance_count() const { return state_ ? state_->instance_count : 0; }

std::vector<GroupIndex> Crowd::groups() const {
    std::vector<GroupIndex> numbers;
    for (uint32_t i = 0; state_ && i < state_->groups.size(); ++i)
        if (!state_->groups[i].is_gone()) numbers.push_back(i);
    return numbers;
}

Result<GroupIndex> Crowd::group_of(const InstanceHandle& instance) const {
    return as_result([&]() -> GroupIndex {
        if (const Batch* const batch = batch_at(state().batches, instance.instance)) return batch->group;
        throw Failure(ErrorCode::kInvalidArgument, "instance " + std::to_string(instance.instance),
                      "no group has an instance of this number");
    });
}

Result<GroupPath> Crowd::path(GroupIndex group) const {
    return as_result([&] {
        const Group& of = state().group_at(group);
        std::string reason = shown_reason(of.native, of.path_reason);
        if (state().cull && !of.animates_drawn_only()) {
            reason += "; animates all of its instances, with all joints, whatever the view";
            if (!of.fused.empty()) reason += of.sockets ? ": it has sockets" : ": it has inertial transitions";
        }
        return GroupPath{!of.fused.empty(), of.native, std::move(reason), {name_of(of.scan_choice), of.scan_reason}};
    });
}

Result<std::vector<GroupIndex>> Crowd::add_groups(Crowd&& other) {
    return as_result([&] {
        std::vector<GroupIndex> numbers = state().add_groups(other.state());
        other.state_.reset();
        return numbers;
    });
}

Result<void> Crowd::remove_group(GroupIndex group) {
    return as_result([&] { state().remove_group(group); });
}

Result<std::vector<InstanceHandle>> Crowd::spawn(GroupIndex group, std::span<const Affine> world_from_model) {
    return as_result([&] { return state().spawn(group, world_from_model); });
}

Result<void> Crowd::despawn(std::span<const InstanceHandle> instances) {
    return as_result([&] { state().despawn(instances); });
}

bool Crowd::is_alive(const InstanceHandle& instance) const { return state_ && state_->is_alive(instance); }

Result<InstanceHandle> Crowd::handle(uint32_t instance) const {
    return as_result([&] { return state().handle(instance); });
}

Result<uint32_t> Crowd::alive_count(GroupIndex group) const {
    return as_result([&] { return state().alive_count(group); });
}

Instances Crowd::instances() const { return Instances::numbered(0, instance_count()); }

Result<Instances> Crowd::instances(GroupIndex group) const {
    return as_result([&] { return state().instances(group); });
}

Result<void> Crowd::set_playback(const Instances& instances, const Playback& playback) {
    return as_result([&] { state().set_playback(instances, Each(playback)); });
}

Result<void> Crowd::set_playback(const Instances& instances, std::span<const Playback> playback) {
    return as_result([&] { state().set_playback(instances, Each(instances, playback, "playback")); });
}

Result<void> Crowd::set_placement(const Instances& instances, const Affine& world_from_model) {
    return as_result([&] { state().set_placement(instances, Each(world_from_model)); });
}

Result<void> Crowd::set_placement(const Instances& instances, std::span<const Affine> world_from_model) {
    return as_result([&] { state().set_placement(instances, Each(instances, world_from_model, "placement")); });
}

Result<void> Crowd::set_look(const Instances& instances, const InstanceLook& look) {
    return as_result([&] { state().set_look(instances, Each(look)); });
}

Result<void> Crowd::set_look(const Instances& instances, std::span<const InstanceLook> look) {
    return as_result([&] { state().set_look(instances, Each(instances, look, "look")); });
}

Result<void> Crowd::attach(const Instances& instances, const Attachment& attachment) {
    return as_result([&] { state().attach(instances, Each(attachment)); });
}

Result<void> Crowd::attach(const Instances& instances, std::span<const Attachment> attachment) {
    return as_result([&] { state().attach(instances, Each(instances, attachment, "attachment")); });
}

Result<void> Crowd::detach(const Instances& instances) {
    return as_result([&] { state().detach(instances); });
}

Result<void> Crowd::play(const Instances& instances, LayerIndex layer, const LayerPlayback& playback) {
    return as_result([&] { state().play(instances, layer, Each(playback)); });
}

Result<void> Crowd::play(const Instances& instances, LayerIndex layer, std::span<const LayerPlayback> playback) {
    return as_result([&] { state().play(instances, layer, Each(instances, playback, "play")); });
}

Result<void> Crowd::set_state(const Instances& instances, LayerIndex layer, const PlayedMotion& motion, float fade_s) {
    return as_result([&] { state().set_state(instances, layer, Each(motion), fade_s); });
}

Result<void> Crowd::set_state(const Instances& instances, LayerIndex layer, std::span<const PlayedMotion> motion,
                              float fade_s) {
    return as_result([&] { state().set_state(instances, layer, Each(instances, motion, "state"), fade_s); });
}

Result<void> Crowd::set_layer(const Instances& instances, LayerIndex layer, const LayerBlend& blend) {
    return as_result([&] { state().set_layer(instances, layer, Each(blend)); });
}

Result<void> Crowd::set_layer(const Instances& instances, LayerIndex layer, std::span<const LayerBlend> blend) {
    return as_result([&] { state().set_layer(instances, layer, Each(instances, blend, "layer")); });
}

Result<void> Crowd::set_parameter(const Instances& instances, ParameterIndex parameter, float value) {
    return as_result([&] { state().set_parameter(instances, parameter, Each(value)); });
}

Result<void> Crowd::set_parameter(const Instances& instances, ParameterIndex parameter, std::span<const float> value) {
    return as_result([&] { state().set_parameter(instances, parameter, Each(instances, value, "parameter")); });
}

Result<void> Crowd::set_target(const Instances& instances, TargetIndex target, const TargetPlace& place) {
    return as_result([&] { state().set_target(instances, target, Each(place)); });
}

Result<void> Crowd::set_target(const Instances& instances, TargetIndex target, std::span<const TargetPlace> place) {
    return as_result([&] { state().set_target(instances, target, Each(instances, place, "target")); });
}

Result<void> Crowd::set_wind(const Wind& wind) {
    return as_result([&] { state().procedural->set_wind(wind); });
}

Result<void> Crowd::set_destination(const Instances& instances, const Vec3<float>& world_place) {
    return as_result([&] { state().set_destination(instances, Each(world_place)); });
}

Result<void> Crowd::set_destination(const Instances& instances, std::span<const Vec3<float>> world_place) {
    return as_result([&] { state().set_destination(instances, Each(instances, world_place, "destination")); });
}

Result<void> Crowd::clear_destination(const Instances& instances) {
    return as_result([&] { state().clear_destination(instances); });
}

Result<void> Crowd::set_pose(const Instances& instances, std::span<const Trs<float>> parent_from_joint, float fade_s) {
    return as_result([&] { state().set_pose(instances, parent_from_joint, fade_s); });
}

Result<void> Crowd::clear_pose(const Instances& instances, float fade_s) {
    return as_result([&] { state().clear_pose(instances, fade_s); });
}

Result<void> Crowd::watch(const Instances& instances) {
    return as_result([&] { state().watch(instances); });
}

Result<void> Crowd::request_poses(const Instances& instances) {
    return as_result([&] { state().request_poses(instances); });
}

Result<std::vector<Feedback>> Crowd::feedback() {
    return as_result([&] { return state().take_feedback(); });
}

Result<void> Crowd::record_uploads(VkCommandBuffer commands) {
    return as_result(
        [&] {
            if (!commands && !state().gpu->is_native())
                throw Failure(ErrorCode::kInvalidArgument, "command buffer", "it is VK_NULL_HANDLE");
            state().record_uploads(commands);
        },
        "crowd");
}

Result<void> Crowd::record(VkCommandBuffer commands, float time_step_s, const CrowdView* view) {
    return as_result(
        [&] {
            const bool is_native = state().gpu->is_native();
            if (is_native == (commands != VK_NULL_HANDLE))
                throw Failure(ErrorCode::kInvalidArgument, "command buffer",
                              is_native ? "it must be VK_NULL_HANDLE on a native device; or call update()"
                                        : "it is VK_NULL_HANDLE");
            state().record(commands, time_step_s, view);
        },
        "crowd");
}

Result<void> Crowd::record_disoccluded(VkCommandBuffer commands, const DepthImage& depths) {
    return as_result(
        [&] {
            if (!commands && !state().gpu->is_native())
                throw Failure(ErrorCode::kInvalidArgument, "command buffer", "it is VK_NULL_HANDLE");
            state().record_disoccluded(commands, depths);
        },
        "crowd");
}

Result<void> Crowd::discard_last_record() {
    return as_result([&] { state().discard_last_record(); }, "crowd");
}

Result<std::vector<std::byte>> Crowd::save_state() {
    std::vector<std::byte> bytes;
    const Result<void> saved = save_state(bytes);
    if (!saved) return saved.error();
    return bytes;
}

Result<void> Crowd::save_state(std::vector<std::byte>& out) {
    return as_result([&] { state().save_state(out); }, "crowd");
}

Result<void> Crowd::restore_state(std::span<const std::byte> bytes) {
    return as_result([&] { state().restore_state(bytes); }, "crowd");
}

Result<void> Crowd::update(float time_step_s, const CrowdView* view) {
    return as_result([&] { state().update(time_step_s, view); }, "crowd");
}

Result<std::vector<DrawnInstance>> Crowd::read_drawn() {
    return as_result([&] { return state().read_drawn(); });
}

std::span<const OutputBlock> Crowd::outputs() const { return outputs(frame_slot()); }

std::span<const OutputBlock> Crowd::outputs(uint32_t frame_slot) const {
    return frame_slot < frame_slot_count() ? std::span<const OutputBlock>(state_->outputs[frame_slot])
                                           : std::span<const OutputBlock>();
}

uint32_t Crowd::frame_slot_count() const { return state_ ? static_cast<uint32_t>(state_->outputs.size()) : 0; }

uint32_t Crowd::frame_slot() const { return state_ ? state_->slot : 0; }

Result<GroupMesh> Crowd::mesh(GroupIndex group) const {
    return as_result([&] { return state().group_at(group).mesh(); });
}

Result<StageTimes> Crowd::stage_times() const {
    return as_result([&] {
        if (!state().timer)
            throw Failure(ErrorCode::kInvalidArgument, "stage times",
                          "CrowdSettings::timestamps is off, or the queue has no timestamps");
        return state().timer->read();
    });
}

Result<std::vector<Affine>> Crowd::read_skin_matrices(const InstanceHandle& instance) {
    return as_result([&] { return state().read_matrices(instance, false); });
}

Result<std::vector<Affine>> Crowd::read_model_matrices(const InstanceHandle& instance) {
    return as_result([&] { return state().read_matrices(instance, true); });
}

Result<std::vector<Vec3<float>>> Crowd::read_positions(const InstanceHandle& instance) {
    return as_result([&] { return state().read_positions(instance); });
}

uint64_t Crowd::size_bytes() const { return state_ ? state_->size_bytes() : 0; }

}  // namespace throng
