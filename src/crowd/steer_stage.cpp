#include "crowd/steer_stage.h"

#include "base/failure.h"
#include "base/message_name.h"
#include "crowd/change_stage.h"
#include "crowd/state_archive.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <numbers>

namespace throng {

void check_steering(const CrowdGroup& group) {
    if (!group.steering) return;
    const Steering& steering = *group.steering;
    const auto check = [&](const char* what, float value, float least) {
        constexpr float kMaximum = 1e6f;
        if (!(value >= least && value <= kMaximum))
            throw Failure(ErrorCode::kInvalidArgument, message_name(group.character->name) + ": steering",
                          std::string(what) + " " + std::to_string(value) + "; give one from " +
                              (least > 0 ? "0.000001" : "0") + " to 1000000");
    };
    check("radius", steering.radius, 1e-6f);
    check("speed", steering.speed, 0);
    check("turn", steering.turn, 0);
    const size_t parameter_count = group.controller ? group.controller->parameters.size() : 0;
    if (steering.speed_parameter != kNone && steering.speed_parameter >= parameter_count)
        throw Failure(ErrorCode::kInvalidArgument, message_name(group.character->name) + ": steering",
                      "speed_parameter " + std::to_string(steering.speed_parameter) +
                          " is out of range: the group has " + std::to_string(parameter_count) + " parameters");
}

void SteerStage::plan(BatchPlan& plan) {
    if (!plan.group().steering) return;
    plan.add_filled(io::kDestinationsBuffer, std::vector<io::vec4>(1));
    plan.add_filled(io::kAgentsBuffer, std::vector<io::AgentState>{{.speed = 0, .patience = 1, .stands = 0}});
}

SteerStage::SteerStage(const StageContext& context) : Stage(context), served_of_batch_(batches_.size(), kNone) {
    uint64_t agent_count = 0;
    std::vector<float> radii;
    for (const Batch& batch : batches_) {
        if (!group_of(batch).steering) continue;
        agent_count += batch.instance_count;
        radii.push_back(group_of(batch).steering->radius);
    }
    if (agent_count == 0) return;
    grids_ = agent_grids(std::move(radii));
    const uint64_t bucket_count = std::bit_ceil(2 * agent_count);
    kernels_.emplace(gpu_);
    places_ = make_table<io::AgentPlace>(gpu_, "places of agents", agent_count);
    buckets_ = make_table<uint32_t>(gpu_, "buckets of agents", bucket_count);
    bucket_mask_ = static_cast<uint32_t>(bucket_count - 1);
    uint32_t first_agent = 0;
    for (uint32_t i = 0; i < batches_.size(); ++i) {
        const Batch& batch = batches_[i];
        if (!group_of(batch).steering) continue;
        served_of_batch_[i] = static_cast<uint32_t>(served_.size());
        const BufferTable table = batch.table(group_of(batch), batch[io::kAgentsBuffer])
                                      .set({{io::kAgentPlacesBuffer, places_}, {io::kAgentBucketsBuffer, buckets_}});
        served_.push_back({.batch = i,
                           .first_agent = first_agent,
                           .destinations = std::vector<io::vec4>(batch.instance_count),
                           .dirty = {},
                           .places = kernels_->places.bind(table),
                           .steer = kernels_->steer.bind(table)});
        first_agent += batch.instance_count;
    }
}

void SteerStage::set_destination(const InBatch& at, const io::vec4& place_and_whether) {
    ServedBatch& served = served_[served_of_batch_[at.batch]];
    served.destinations[at.instance] = place_and_whether;
    served.dirty.add(at.instance, 1);
}

void SteerStage::despawn(std::span<const InstanceHandle> gone) {
    for (const InstanceHandle& one : gone)
        if (const InBatch at = in_batch(batches_, one.instance); served_of_batch_[at.batch] != kNone)
            set_destination(at, {});
}

void SteerStage::begin(const Update& update) {
    if (served_.empty()) return;
    for (ServedBatch& served : served_) {
        const std::span<const DirtyRanges::Range> ranges = served.dirty.take();
        for (const auto& [first, count] : ranges)
            update.changes->write(update, ranges.size(), batches_[served.batch], io::kDestinationsBuffer, first,
                                  std::span<const io::vec4>(served.destinations).subspan(first, count));
    }
    record_fill(*gpu_, update.commands, buckets_, kNone);
}

void SteerStage::discard() {
    for (ServedBatch& served : served_) served.dirty.put_back();
}

void SteerStage::record(const Update& update) {
    const bool takes_steps = update.time_step_s > 0;
    const auto has_work = [&](const ServedBatch& served) {
        return takes_steps || group_of(batches_[served.batch]).varies;
    };
    if (std::ranges::none_of(served_, has_work)) return;
    if (takes_steps) {
        for (const ServedBatch& served : served_) record_places(update.commands, served);
        separate_kernels(update.commands);
    }
    for (const ServedBatch& served : served_)
        if (has_work(served)) record_steps(update.commands, served, update.time_step_s);
    separate_kernels(update.commands);
    update.end_stage("steer");
}

void SteerStage::record_places(VkCommandBuffer commands, const ServedBatch& served) const {
    const Batch& batch = batches_[served.batch];
    const float radius = group_of(batch).steering->radius;
    const uint32_t grid = grid_of(grids_, radius);
    const io::PlacesPush push{batch.used_count,          served.first_agent, radius,     grid,
                              grids_[grid].inverse_cell, bucket_mask_,       batch.birth};
    kernels_->places.dispatch_invocations(commands, served.places, push, batch.used_count);
}

void SteerStage::record_steps(VkCommandBuffer commands, const ServedBatch& served, float time_step_s) const {
    const Batch& batch = batches_[served.batch];
    const Group& group = group_of(batch);
    const double turn_rad = std::min(double{group.steering->turn} * double{time_step_s}, std::numbers::pi);
    io::SteerPush push{.instance_count = batch.used_count,
                       .first_agent = served.first_agent,
                       .bucket_mask = bucket_mask_,
                       .speed = group.steering->speed,
                       .turn_cos = static_cast<float>(std::cos(turn_rad)),
                       .turn_sin = static_cast<float>(std::sin(turn_rad)),
                       .time_step_s = time_step_s,
                       .is_carried = batch[io::kRootsBuffer] && group.controller->applies_root_motion,
                       .parameter_count = group.controller ? group.controller->parameter_count : 0,
                       .speed_parameter = group.steering->speed_parameter,
                       .birth = batch.birth,
                       .grid_count = static_cast<uint32_t>(grids_.size()),
                       .largest = {},
                       .inverse_cells = {}};
    for (size_t i = 0; i < grids_.size(); ++i) {
        push.largest[i] = grids_[i].largest;
        push.inverse_cells[i] = grids_[i].inverse_cell;
    }
    kernels_->steer.dispatch_invocations(commands, served.steer, push, batch.used_count);
}

void SteerStage::exchange_group(StateArchive& archive, uint32_t group) {
    for (ServedBatch& served : served_) {
        if (batches_[served.batch].group != group) continue;
        archive.finite_values(served.destinations, "a destination is not finite");
        archive.changes(served.dirty, 0, static_cast<uint32_t>(served.destinations.size()));
    }
}

}  // namespace throng
