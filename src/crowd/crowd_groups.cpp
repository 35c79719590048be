// Adds and removes groups. A stage covers all groups, so a change of groups makes all stages anew, over the existing
// buffers. The new stages continue from the state of the old ones.
#include "base/failure.h"
#include "crowd/crowd_state.h"
#include "crowd/state_archive.h"

#include <algorithm>
#include <typeinfo>

namespace throng {
namespace {

// The first setting that differs, among those that buffers and kernels depend on.
std::string_view difference(const CrowdSettings& a, const CrowdSettings& b) {
    const auto culling_differs = [&](bool Culling::*setting) {
        return a.culling && b.culling && (*a.culling).*setting != (*b.culling).*setting;
    };
    if (a.skin_format != b.skin_format) return "skin_format";
    if (a.skin_blend != b.skin_blend) return "skin_blend";
    if (a.skins_once != b.skins_once) return "skins_once";
    if (a.keep_model_matrices != b.keep_model_matrices) return "keep_model_matrices";
    if (a.keep_previous_matrices != b.keep_previous_matrices) return "keep_previous_matrices";
    if (a.frames_in_flight != b.frames_in_flight) return "frames_in_flight";
    if (a.culling.has_value() != b.culling.has_value())
        return a.culling ? "culling: the other one needs it too (CrowdGroup::capacity and skin_pool turn it on)"
                         : "culling: only the other one has it (CrowdGroup::capacity and skin_pool turn it on)";
    if (culling_differs(&Culling::skips_updates)) return "Culling::skips_updates";
    if (culling_differs(&Culling::reduces_joints)) return "Culling::reduces_joints";
    if ((a.pose_request_capacity > 0) != (b.pose_request_capacity > 0))
        return "pose_request_capacity, which must be above 0 in both or in neither";
    return {};
}

}  // namespace

void CrowdState::check_may_change(const char* what) const {
    if (is_half_recorded_)
        throw Failure(ErrorCode::kInvalidArgument, what,
                      "the last record() failed halfway: restore a saved state first");
    if (cull && cull->is_half_done())
        throw Failure(ErrorCode::kInvalidArgument, what,
                      "the last record() was for a view with occlusion: call record_disoccluded() first");
}

void CrowdState::check_goes_with(const CrowdState& other) const {
    constexpr const char* kPlace = "add groups";
    if (&other == this || other.groups.empty())
        throw Failure(ErrorCode::kInvalidArgument, kPlace, "the other crowd is this one, or has been added before");
    if (other.gpu != gpu) throw Failure(ErrorCode::kInvalidArgument, kPlace, "the other crowd lives on another device");
    if (other.has_updated_ || other.can_discard_ || other.is_half_recorded_)
        throw Failure(ErrorCode::kInvalidArgument, kPlace, "the other crowd has been updated");
    if (const std::string_view setting = difference(settings_, other.settings_); !setting.empty())
        throw Failure(ErrorCode::kInvalidArgument, kPlace, "the two crowds differ in CrowdSettings::", setting);
    for (const Group& group : other.groups) {
        if (!natively_ && other.natively_ && group.sockets_only)
            throw Failure(ErrorCode::kUnsupported, kPlace, group.name,
                          " has CrowdGroup::sockets_only, which needs native updates, and this crowd's are not native");
        if (natively_ && !other.natively_ && !group.is_gone())
            throw Failure(ErrorCode::kUnsupported, kPlace, group.name,
                          " is not updated natively, but this crowd is; make this crowd with UpdatePath::kDevice");
    }
    if (uint64_t{instance_count} + other.instance_count > UINT32_MAX)
        throw Failure(ErrorCode::kLimit, kPlace, "more than 4,294,967,295 instances");
    check_memory("matrices and state", size_bytes() + other.size_bytes());
}

std::vector<CrowdState::StageState> CrowdState::stage_states() const {
    std::vector<StageState> all;
    for (const auto& stage : stages) {
        StageState& state = all.emplace_back(StageState{.stage = stage.get(), .of_crowd = {}, .of_groups = {}});
        StateArchive of_crowd;
        stage->exchange(of_crowd);
        state.of_crowd = of_crowd.take();
        for (uint32_t group = 0; group < groups.size(); ++group) {
            if (groups[group].is_gone()) continue;
            StateArchive of_group;
            stage->exchange_group(of_group, group);
            state.of_groups[group] = of_group.take();
        }
    }
    return all;
}

// Chooses the lowest numbers for the group and its instances that no group of this crowd and no earlier move has.
CrowdState::Move CrowdState::plan_move(const CrowdState& from, uint32_t group, std::span<const Move> others) const {
    const Instances instances = from.instances(group);
    Move move{.from = group, .first_from = instances.first(), .count = instances.size()};
    const auto is_taken = [&](uint32_t number) {
        return (number < groups.size() && !groups[number].is_gone()) ||
               std::ranges::find(others, number, &Move::to) != others.end();
    };
    while (is_taken(move.to)) ++move.to;
    std::vector<std::pair<uint32_t, uint32_t>> taken;  // from and to
    for (const Batch& batch : batches)
        taken.emplace_back(batch.first_instance, batch.first_instance + batch.instance_count);
    for (const Move& other : others) taken.emplace_back(other.first_to, other.first_to + other.count);
    std::ranges::sort(taken);
    for (const auto& [first, end] : taken) {
        if (first - move.first_to >= move.count) break;
        move.first_to = end;
    }
    return move;
}

CrowdState::GroupInTransit CrowdState::take_out(uint32_t group) {
    GroupInTransit moving{.group = std::exchange(groups[group], Group()),
                          .settings = std::exchange(settings_.groups[group], CrowdGroup()),
                          .batches = {}};
    std::vector<Batch> staying;
    for (Batch& batch : batches) (batch.group == group ? moving.batches : staying).push_back(std::move(batch));
    batches = std::move(staying);
    count_instances();
    return moving;
}

void CrowdState::put_in(GroupInTransit moving, uint32_t group, uint32_t first_instance) {
    if (group >= groups.size()) {
        groups.resize(group + 1);
        settings_.groups.resize(group + 1);
    }
    groups[group] = std::move(moving.group);
    settings_.groups[group] = std::move(moving.settings);
    uint32_t next_instance = first_instance;
    for (Batch& batch : moving.batches) {
        batch.group = group;
        batch.first_instance = std::exchange(next_instance, next_instance + batch.instance_count);
        batch.slot = slot;
        batches.push_back(std::move(batch));
    }
    std::ranges::sort(batches, {}, &Batch::first_instance);
    count_instances();
}

void CrowdState::count_instances() {
    instance_count = batches.empty() ? 0 : batches.back().first_instance + batches.back().instance_count;
}

// Does everything about a change of groups that can fail. `moves`: of groups that join the crowd, whose states are
// `joining`, or leave it.
CrowdState::RebuiltStages CrowdState::rebuild_stages(std::span<const StageState> before,
                                                     std::span<const StageState> joining, std::span<const Move> moves) {
    RebuiltStages made{.uploads = std::make_unique<FirstUploads>(gpu, events_)};
    made.stages = make_stages(made.uploads->uploads);
    const auto renumbered = [&](uint32_t number) {
        for (const Move& move : moves)
            if (number - move.first_from < move.count)
                return move.to == kNone ? kNone : number - move.first_from + move.first_to;
        return number;
    };
    for (const auto& stage : made.stages) {
        const Stage& wanted = *stage;
        const auto of_stage = [&](std::span<const StageState> states) {
            return std::ranges::find_if(states, [&](const StageState& state) {
                const Stage& one = *state.stage;
                return typeid(one) == typeid(wanted);
            });
        };
        const auto read_group = [&](const std::vector<std::byte>& bytes, uint32_t group, bool renumbers) {
            StateArchive archive{std::span<const std::byte>(bytes)};
            if (renumbers) archive.set_renumber(renumbered);
            stage->exchange_group(archive, group);
        };
        if (const auto state = of_stage(before); state != before.end()) {
            StateArchive archive{std::span<const std::byte>(state->of_crowd)};
            stage->exchange(archive);
            for (const auto& [group, bytes] : state->of_groups)
                if (!groups[group].is_gone()) read_group(bytes, group, joining.empty());
        }
        if (const auto state = of_stage(joining); state != joining.end())
            for (const Move& move : moves) read_group(state->of_groups.at(move.from), move.to, true);
    }
    find_stage<PlacementStage>(made.stages)->follow_like(*placements);
    if (timer && end_count_of(made.stages) > timer_room_) made.timer = make_timer(made.stages);
    // The feedback of an update is kept for four more updates and refers to data of its groups. Its outputs are read
    // while up to frames_in_flight more updates are computed.
    constexpr uint32_t kUpdates = 5;
    made.retired.emplace(events_, std::max(kUpdates, settings_.frames_in_flight + 1));
    return made;
}

std::vector<GroupIndex> CrowdState::add_groups(CrowdState& from) {
    check_may_change("add groups");
    check_goes_with(from);
    const std::vector<StageState> before = stage_states(), joining = from.stage_states();
    std::vector<Move> moves;
    for (uint32_t group = 0; group < from.groups.size(); ++group)
        if (!from.groups[group].is_gone()) moves.push_back(plan_move(from, group, moves));
    std::vector<GroupIndex> numbers;
    for (const Move& move : moves) {
        put_in(from.take_out(move.from), move.to, move.first_to);
        if (!natively_) groups[move.to].leave_native("the crowd's other groups are not updated natively");
        numbers.push_back(move.to);
    }
    RebuiltStages made;
    try {
        make_feedback();
        made = rebuild_stages(before, joining, moves);
    } catch (...) {
        for (const Move& move : moves) from.put_in(take_out(move.to), move.from, move.first_from);
        from.natively_ = from.natively_ && natively_;
        throw;
    }
    for (auto& uploads : from.first_uploads_) first_uploads_.push_back(std::move(uploads));
    from.groups.clear();
    commit_group_change(std::move(made), {.stages = std::move(from.stages)});
    for (const GroupIndex group : numbers) population->join_group(group);
    return numbers;
}

void CrowdState::remove_group(uint32_t group) {
    group_at(group);
    check_may_change("remove group");
    if (std::ranges::all_of(batches, [&](const Batch& batch) { return batch.group == group; }))
        throw Failure(ErrorCode::kInvalidArgument, "remove group",
                      "it is the only group with instances, and a crowd needs one");
    population->end_group(group);
    const std::vector<StageState> before = stage_states();
    const Instances gone = instances(group);
    const Move move{.from = group, .to = kNone, .first_from = gone.first(), .first_to = kNone, .count = gone.size()};
    GroupInTransit moving = take_out(group);
    RebuiltStages made;
    try {
        made = rebuild_stages(before, {}, std::span(&move, 1));
    } catch (...) {
        put_in(std::move(moving), group, move.first_from);
        throw;
    }
    commit_group_change(std::move(made), {.batches = std::move(moving.batches), .group = std::move(moving.group)});
}

// `gone`: what updates under way may still use, apart from the old stages.
void CrowdState::commit_group_change(RebuiltStages made, Retired::Things gone) {
    for (auto& stage : stages) gone.stages.push_back(std::move(stage));
    use_stages(std::move(made.stages));
    first_uploads_.push_back(std::move(made.uploads));
    if (made.timer) {
        gone.timer = std::exchange(timer, std::move(made.timer));
        timer_room_ = timer_room_for(stages);
    }
    made.retired->keep(std::move(gone));
    retired_.push_back(std::move(*made.retired));
    make_outputs();
    if (gpu->is_native()) finish_uploads();
    can_discard_ = false;
    const auto is_gone = [&](uint32_t instance) { return !batch_at(batches, instance); };
    std::erase_if(watched_, [&](const Watched& watched) { return is_gone(watched.instance); });
    std::erase_if(pose_requests_, is_gone);
}

}  // namespace throng
