#include "crowd/attach_stage.h"

#include "attach/attach.kernel.h"
#include "base/failure.h"
#include "base/finite.h"
#include "base/message_name.h"
#include "crowd/change_stage.h"
#include "crowd/placement_stage.h"
#include "crowd/state_archive.h"

#include <algorithm>
#include <cstring>
#include <set>

namespace throng {
namespace {

constexpr io::InstanceAttachment kUnattached{.carrier_batch = kNone};
constexpr uint32_t kMaxLevels = 64;  // each is a dispatch, which waits for the one before

bool has_world_sockets(const Group& group) { return group.sockets && group.socket_space == SocketSpace::kWorld; }

}  // namespace

void check_carried(const CrowdGroup& group) {
    if (!group.is_carried) return;
    const std::string place = message_name(group.character->name) + ": is_carried";
    if (group.steering || group.terrain)
        throw Failure(ErrorCode::kInvalidArgument, place, "not together with steering or terrain");
    if (group.controller && group.moves_placements && !group.character->root_rows.empty())
        throw Failure(ErrorCode::kInvalidArgument, place,
                      "not together with root motion that moves placements: set moves_placements to false");
}

bool AttachStage::is_needed(const CrowdSettings& settings) {
    return std::ranges::any_of(settings.groups, &CrowdGroup::is_carried);
}

void AttachStage::plan(BatchPlan& plan) {
    plan.add_host(sizeof(attachments_[0]));
    if (plan.group().is_carried) plan.add_storage(io::kAttachmentsBuffer, sizeof(io::InstanceAttachment));
}

AttachStage::AttachStage(const StageContext& context)
    : Stage(context), attachments_(context.instance_count, kUnattached), kernel_(kernels::attach.on(gpu_)) {
    dirty_.add(0, context.instance_count);
    for (uint32_t carried = 0; carried < batches_.size(); ++carried) {
        const Batch& batch = batches_[carried];
        const Group& group = group_of(batch);
        if (!group.is_carried) continue;
        const auto add = [&](uint32_t carrier, const Buffer& sockets) {
            const BufferTable table =
                batch.table(group, batch[io::kPlacementsBuffer]).set({{io::kCarrierSocketsBuffer, sockets}});
            pairs_.try_emplace({carried, carrier}, Pair{.bindings = kernel_.bind(table), .counts = {}});
        };
        for (uint32_t carrier = 0; carrier < batches_.size(); ++carrier)
            if (has_world_sockets(group_of(batches_[carrier]))) add(carrier, batches_[carrier][io::kSocketsBuffer]);
        if (has_world_sockets(group)) add(kNone, batch[io::kSocketsBuffer]);
    }
}

bool AttachStage::is_possible(const io::InstanceAttachment& attachment) const {
    if (attachment.carrier_batch >= batches_.size()) return false;
    const Batch& batch = batches_[attachment.carrier_batch];
    return attachment.carrier < batch.instance_count && attachment.socket < group_of(batch).socket_count() &&
           has_world_sockets(group_of(batch));
}

io::InstanceAttachment AttachStage::to_io(uint32_t instance, const Attachment& attachment) const {
    const ErrorPlace place("attachment", instance);
    if (!group_at(instance).is_carried) refuse(place, "its group does not have CrowdGroup::is_carried set");
    const InBatch carrier = in_batch(batches_, attachment.carrier.instance);
    io::InstanceAttachment made{
        .carrier_batch = carrier.batch, .carrier = carrier.instance, .socket = attachment.socket, .level = 1};
    std::memcpy(made.socket_from_model, &attachment.socket_from_model, sizeof attachment.socket_from_model);
    const Group& of_carrier = group_of(batches_[carrier.batch]);
    if (!is_possible(made))
        refuse(place, "there is no socket ", attachment.socket, " in world space: the carrier has ",
               of_carrier.socket_count(), " sockets, in ",
               of_carrier.socket_space == SocketSpace::kWorld ? "world" : "model", " space");
    if (!all_finite(attachment.socket_from_model)) refuse(place, "socket_from_model: a number is not finite");
    return made;
}

void AttachStage::attach(const Instances& instances, const Each<Attachment>& attachment) {
    std::vector<io::InstanceAttachment> all, before;
    bool may_chain = false;  // whether a carrier may be carried itself
    for (uint32_t i = 0; i < instances.size(); ++i) {
        all.push_back(to_io(instances.number(i), attachment[i]));
        may_chain = may_chain || group_at(instances.number(i)).sockets ||
                    group_of(batches_[all.back().carrier_batch]).is_carried;
    }
    for (uint32_t i = 0; i < instances.size(); ++i) {
        before.push_back(attachments_[instances.number(i)]);
        set(instances.number(i), all[i]);
    }
    if (!may_chain) return;
    try {
        if (const std::string mistake = set_levels(); !mistake.empty()) refuse("attachment", mistake);
    } catch (...) {
        for (uint32_t i = instances.size(); i-- > 0;) set(instances.number(i), before[i]);
        throw;
    }
}

void AttachStage::detach(const Instances& instances) {
    for (uint32_t i = 0; i < instances.size(); ++i) set(instances.number(i), kUnattached);
}

void AttachStage::despawn(std::span<const InstanceHandle> gone) {
    std::set<std::pair<uint32_t, uint32_t>> carriers;
    for (const InstanceHandle& one : gone) {
        if (group_at(one.instance).is_carried) set(one.instance, kUnattached);
        const InBatch at = in_batch(batches_, one.instance);
        if (batches_[at.batch][io::kSocketsBuffer]) carriers.insert({at.batch, at.instance});
    }
    if (carriers.empty()) return;
    for (uint32_t i = 0; i < attachments_.size(); ++i)
        if (carriers.contains({attachments_[i].carrier_batch, attachments_[i].carrier})) set(i, kUnattached);
}

void AttachStage::set(uint32_t instance, const io::InstanceAttachment& attachment) {
    const uint32_t carried = batch_index_of(batches_, instance);
    const auto add = [&](const io::InstanceAttachment& to, uint32_t count) {
        if (to.carrier_batch == kNone) return;
        std::vector<uint32_t>& counts = pairs_.at({carried, to.carrier_batch}).counts;
        if (counts.size() <= to.level) counts.resize(to.level + 1);
        counts[to.level] += count;
    };
    add(attachments_[instance], ~0u);  // one less
    add(attachment, 1);
    attachments_[instance] = attachment;
    dirty_.add(instance, 1);
}

// The number of its carrier in the crowd; kNone if it is not attached.
uint32_t AttachStage::carrier_of(uint32_t instance) const {
    const io::InstanceAttachment& to = attachments_[instance];
    return to.carrier_batch == kNone ? kNone : batches_[to.carrier_batch].first_instance + to.carrier;
}

// Gives each attachment its level, one more than its carrier's: follows the carriers up to one whose level is known,
// and numbers those in between on the way back. Returns an error message, empty where there is no error; on an error no
// level changes. detach() need not call this: levels are then higher than necessary, but still above the carrier's.
std::string AttachStage::set_levels() {
    constexpr uint32_t kUnknown = kNone, kInProgress = kNone - 1;
    std::vector<uint32_t> levels(attachments_.size(), kUnknown), way;
    for (uint32_t instance = 0; instance < levels.size(); ++instance) {
        uint32_t at = instance;
        for (way.clear(); at != kNone && levels[at] == kUnknown; at = carrier_of(at)) {
            levels[at] = kInProgress;
            way.push_back(at);
        }
        uint32_t level = at == kNone ? ~0u : levels[at];
        if (level == kInProgress)
            return "instance " + std::to_string(at) + " would be attached to itself, directly or through others";
        for (; !way.empty(); way.pop_back()) levels[way.back()] = ++level;
        if (levels[instance] > kMaxLevels)
            return "instance " + std::to_string(instance) + " would be attached to a chain of more than " +
                   std::to_string(kMaxLevels) + " carriers";
    }
    for (uint32_t instance = 0; instance < levels.size(); ++instance) {
        io::InstanceAttachment moved = attachments_[instance];
        if (moved.level == levels[instance]) continue;
        moved.level = levels[instance];
        set(instance, moved);
    }
    return {};
}

void AttachStage::begin(const Update& update) {
    const std::span<const DirtyRanges::Range> ranges = dirty_.take();
    for_each_part(batches_, ranges, [&](const Batch& batch, uint32_t first, uint32_t count) {
        if (batch[io::kAttachmentsBuffer])
            update.changes->write(update, ranges.size(), batch, io::kAttachmentsBuffer, first - batch.first_instance,
                                  std::span<const io::InstanceAttachment>(attachments_).subspan(first, count));
    });
}

// Level by level, since each depends on the one before. There is also a barrier between pairs, since synchronization
// validation treats the placements that two pairs write as one range.
void AttachStage::record(const Update& update) {
    size_t level_count = 1;
    for (const auto& [which, pair] : pairs_) level_count = std::max(level_count, pair.counts.size());
    for (uint32_t level = 0; level < level_count; ++level)
        for (const auto& [which, pair] : pairs_) {
            const auto [of_carried, of_carrier] = which;
            const bool is_attached = of_carrier != kNone;
            if (is_attached ? level >= pair.counts.size() || pair.counts[level] == 0 : level > 0) continue;
            const Batch& carried = batches_[of_carried];
            const Group& group = group_of(carried);
            const io::AttachPush push{
                .instance_count = carried.used_count,
                .level = level,
                .carrier_batch = of_carrier,
                .carrier_socket_count = is_attached ? group_of(batches_[of_carrier]).socket_count() : 0,
                .socket_count = has_world_sockets(group) ? group.socket_count() : 0,
                .birth = carried.birth};
            kernel_.dispatch_invocations(update.commands, pair.bindings, push, push.instance_count);
            separate_kernels(update.commands);
        }
    update.end_stage("attach");
}

// Detaches everything before groups are read one after another. Otherwise an attachment that has been read could form a
// cycle with an old one.
void AttachStage::exchange(StateArchive& archive) {
    if (!archive.reads()) return;
    for (uint32_t instance = 0; instance < attachments_.size(); ++instance)
        if (attachments_[instance].carrier_batch != kNone) set(instance, kUnattached);
}

// Stores carriers by their numbers in the crowd. After reading, all attachments go to the device with the next update.
void AttachStage::exchange_group(StateArchive& archive, uint32_t group) {
    for_each_batch_of(group, [&](const Batch& batch, uint32_t) {
        if (!group_of(batch).is_carried) return;
        const auto attachments = std::span(attachments_).subspan(batch.first_instance, batch.instance_count);
        std::vector<io::InstanceAttachment> by_number(attachments.begin(), attachments.end());
        for (io::InstanceAttachment& one : by_number)
            if (one.carrier_batch != kNone) one.carrier += batches_[one.carrier_batch].first_instance;
        for (io::InstanceAttachment& one : by_number) one.level = 0;  // set_levels() finds it again
        archive.values(std::span(by_number));
        if (!archive.reads()) return;
        for (uint32_t i = 0; i < by_number.size(); ++i) {
            io::InstanceAttachment& one = by_number[i];
            if (one.carrier_batch != kNone) one.carrier = archive.renumbered(one.carrier);
            if (one.carrier_batch == kNone || one.carrier == kNone) {
                set(batch.first_instance + i, kUnattached);
                continue;
            }
            const Batch* const carrier = batch_at(batches_, one.carrier);
            StateArchive::require(carrier, "an instance is attached to one that does not exist");
            one.carrier_batch = static_cast<uint32_t>(carrier - batches_.data());
            one.carrier -= carrier->first_instance;
            one.level = 1;
            StateArchive::require(is_possible(one), "an instance is attached to a socket that does not exist");
            set(batch.first_instance + i, one);
        }
        const std::string mistake = set_levels();
        StateArchive::require(mistake.empty(), mistake);
    });
}

}  // namespace throng
