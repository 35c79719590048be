#include "crowd/attach_stage.h"

#include "attach/attach.kernel.h"
#include "base/failure.h"
#include "crowd/placement_stage.h"
#include "crowd/state_archive.h"

#include <algorithm>
#include <cstring>
#include <set>

namespace throng {
namespace {

constexpr io::InstanceAttachment kOnNobody{.carrier_batch = kNone};

}  // namespace

void check_carried(const CrowdGroup& group) {
    if (!group.is_carried) return;
    const std::string place = group.character->name + ": is_carried";
    if (group.steering || group.on_terrain)
        throw Failure(ErrorCode::kInvalidArgument, place, "not together with steering or on_terrain");
    if (!group.sockets.empty())
        throw Failure(ErrorCode::kInvalidArgument, place,
                      "not together with sockets: nothing hangs on what is carried");
    if (group.controller && group.moves_placements && !group.character->root_rows.empty())
        throw Failure(ErrorCode::kInvalidArgument, place,
                      "not together with root motion that moves placements: set moves_placements to false");
}

bool AttachStage::is_needed(const CrowdSettings& settings) {
    return std::ranges::any_of(settings.groups, &CrowdGroup::is_carried);
}

void AttachStage::plan(BatchPlan& plan) {
    if (plan.group().is_carried) plan.add_storage(io::kAttachmentsBuffer, sizeof(io::InstanceAttachment));
}

AttachStage::AttachStage(const StageContext& context)
    : Stage(context), attachments_(context.instance_count, kOnNobody), kernel_(kernels::attach.on(gpu_)) {
    dirty_.add(0, context.instance_count);
    for (uint32_t carried = 0; carried < batches_.size(); ++carried)
        for (uint32_t carrier = 0; carrier < batches_.size(); ++carrier) {
            if (!group_of(batches_[carried]).is_carried || !batches_[carrier][io::kSocketsBuffer]) continue;
            const BufferTable table = batches_[carried]
                                          .table(group_of(batches_[carried]), {})
                                          .set({{io::kSocketsBuffer, batches_[carrier][io::kSocketsBuffer]}});
            pairs_.try_emplace({carried, carrier}, Pair{kernel_.bind(table), 0});
        }
}

bool AttachStage::is_possible(const io::InstanceAttachment& attachment) const {
    if (attachment.carrier_batch >= batches_.size()) return false;
    const Batch& batch = batches_[attachment.carrier_batch];
    return attachment.carrier < batch.instance_count && attachment.socket < group_of(batch).socket_count() &&
           group_of(batch).socket_space == SocketSpace::kWorld;
}

void AttachStage::attach(const Instances& instances, const Each<Attachment>& attachment) {
    std::vector<io::InstanceAttachment> all;
    for (uint32_t i = 0; i < instances.size(); ++i) {
        const std::string place = "attachment of instance " + std::to_string(instances.number(i));
        if (!group_at(instances.number(i)).is_carried)
            throw Failure(ErrorCode::kInvalidArgument, place, "its group is not carried (CrowdGroup::is_carried)");
        const Attachment& to = attachment[i];
        const InBatch carrier = in_batch(batches_, to.carrier.instance);
        io::InstanceAttachment& made = all.emplace_back(
            io::InstanceAttachment{.carrier_batch = carrier.batch, .carrier = carrier.instance, .socket = to.socket});
        std::memcpy(made.socket_from_model, &to.socket_from_model, sizeof to.socket_from_model);
        if (!is_possible(made))
            throw Failure(ErrorCode::kInvalidArgument, place, "the carrier has ",
                          group_at(to.carrier.instance).socket_count(), " sockets, in ",
                          group_at(to.carrier.instance).socket_space == SocketSpace::kWorld ? "world" : "model",
                          " space; there is no socket ", to.socket, " in world space");
        if (!is_finite(to.socket_from_model))
            throw Failure(ErrorCode::kInvalidArgument, place, "socket_from_model: a number is not finite");
    }
    for (uint32_t i = 0; i < instances.size(); ++i) set(instances.number(i), all[i]);
}

void AttachStage::detach(const Instances& instances) {
    for (uint32_t i = 0; i < instances.size(); ++i) set(instances.number(i), kOnNobody);
}

void AttachStage::despawn(std::span<const InstanceHandle> gone) {
    std::set<std::pair<uint32_t, uint32_t>> carriers;
    for (const InstanceHandle& one : gone) {
        if (group_at(one.instance).is_carried) set(one.instance, kOnNobody);
        const InBatch at = in_batch(batches_, one.instance);
        if (batches_[at.batch][io::kSocketsBuffer]) carriers.insert({at.batch, at.instance});
    }
    if (carriers.empty()) return;
    for (uint32_t i = 0; i < attachments_.size(); ++i)
        if (carriers.contains({attachments_[i].carrier_batch, attachments_[i].carrier})) set(i, kOnNobody);
}

void AttachStage::set(uint32_t instance, const io::InstanceAttachment& attachment) {
    const uint32_t carried = batch_index_of(batches_, instance);
    const auto add = [&](uint32_t carrier, uint32_t count) {
        if (carrier != kNone) pairs_.at({carried, carrier}).count += count;
    };
    add(attachments_[instance].carrier_batch, ~0u);  // one less
    add(attachment.carrier_batch, 1);
    attachments_[instance] = attachment;
    dirty_.add(instance, 1);
}

void AttachStage::begin(const Update& update) {
    for_each_part(batches_, dirty_.take(), [&](const Batch& batch, uint32_t first, uint32_t count) {
        if (batch[io::kAttachmentsBuffer])
            record_update(*gpu_, update.commands, batch[io::kAttachmentsBuffer], first - batch.first_instance,
                          std::span<const io::InstanceAttachment>(attachments_).subspan(first, count));
    });
}

void AttachStage::record(const Update& update) {
    for (const auto& [which, pair] : pairs_) {
        if (pair.count == 0) continue;
        const Batch &carried = batches_[which.first], &carrier = batches_[which.second];
        const io::AttachPush push{carried.used_count, which.second, group_of(carrier).socket_count()};
        kernel_.dispatch_invocations(update.commands, pair.bindings, push, push.instance_count);
    }
    separate_kernels(update.commands);
    update.end_stage("attach");
}

// Carriers by their numbers in the crowd. All are handed to the device with the next update.
void AttachStage::exchange_group(StateArchive& archive, uint32_t group) {
    for_each_batch_of(group, [&](const Batch& batch, uint32_t index) {
        if (!group_of(batch).is_carried) return;
        const auto attachments = std::span(attachments_).subspan(batch.first_instance, batch.instance_count);
        std::vector<io::InstanceAttachment> by_number(attachments.begin(), attachments.end());
        for (io::InstanceAttachment& one : by_number)
            if (one.carrier_batch != kNone) one.carrier += batches_[one.carrier_batch].first_instance;
        archive.values(std::span(by_number));
        if (!archive.reads()) return;
        for (auto& [which, pair] : pairs_)
            if (which.first == index) pair.count = 0;
        for (io::InstanceAttachment& one : by_number) {
            if (one.carrier_batch == kNone) continue;
            one.carrier = archive.renumbered(one.carrier);
            if (one.carrier == kNone) {
                one = kOnNobody;
                continue;
            }
            const Batch* const carrier = batch_at(batches_, one.carrier);
            StateArchive::require(carrier, "somebody hangs where nothing is");
            one.carrier_batch = static_cast<uint32_t>(carrier - batches_.data());
            one.carrier -= carrier->first_instance;
            StateArchive::require(is_possible(one), "somebody hangs where nothing is");
            ++pairs_.at({index, one.carrier_batch}).count;
        }
        std::ranges::copy(by_number, attachments.begin());
        dirty_.add(batch.first_instance, batch.instance_count);
    });
}

}  // namespace throng
