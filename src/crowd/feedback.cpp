#include "crowd/feedback.h"

#include "base/failure.h"
#include "bind/skin_format.h"
#include "control/controller_io.h"
#include "gpu/barrier.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <numeric>
#include <tuple>
#include <utility>

namespace throng {

namespace {

Affine over_the_ground(const io::vec4& move) {
    const float x = move.x, z = move.y, cosine = move.z, sine = move.w;
    Affine affine;
    affine.row = {{{cosine, 0, sine, x}, {0, 1, 0, 0}, {-sine, 0, cosine, z}}};
    return affine;
}

constexpr std::array kWatchedParts{&WatchedBatch::placements, &WatchedBatch::roots, &WatchedBatch::sockets,
                                   &WatchedBatch::parameters, &WatchedBatch::layers};

uint64_t event_bytes(uint32_t capacity) { return sizeof(io::EventHead) + capacity * uint64_t{sizeof(io::EventRecord)}; }

}  // namespace

FeedbackRing::FeedbackRing(std::shared_ptr<Gpu> gpu, uint32_t event_capacity, uint64_t instance_bytes)
    : gpu_(std::move(gpu)), event_capacity_(event_capacity), instance_bytes_(instance_bytes) {
    events_ = Buffer(gpu_, "events", event_bytes(event_capacity), VK_BUFFER_USAGE_STORAGE_BUFFER_BIT);
    for (Slot& slot : slots_) {
        slot.copy = make_copy();
        slot.done = DeviceEvent(gpu_);
    }
}

uint64_t FeedbackRing::bytes_needed(uint32_t event_capacity, uint64_t instance_bytes) {
    const uint64_t events_bytes = event_bytes(event_capacity);
    return events_bytes + kSlots * (events_bytes + instance_bytes);
}

Buffer FeedbackRing::make_copy() const {
    return {gpu_, "feedback", events_.size_bytes() + instance_bytes_, VK_BUFFER_USAGE_TRANSFER_DST_BIT,
            MemoryKind::kReadback};
}

bool FeedbackRing::is_full() const {
    return !is_free(slots_, slots_[update_count_ % slots_.size()], [](const Slot& any) { return any.update.number; });
}

void FeedbackRing::drop_pending() {
    for (Slot& slot : slots_)
        if (!slot.done.is_set()) slot.update = {.number = slot.update.number, .is_read = true};
    slots_[(update_count_ - 1) % slots_.size()].done.set();  // so that all slots are free
}

void FeedbackRing::begin(VkCommandBuffer commands) {
    Slot& slot = slots_[update_count_ % slots_.size()];
    if (is_full()) {
        const std::string count = std::to_string(slots_.size());
        throw Failure(ErrorCode::kInvalidArgument, "crowd",
                      "the update recorded " + count + " record()s ago has not finished: at most " + count +
                          " may be in flight; call discard_last_record() for one that will never be submitted");
    }
    if (!slot.done.is_set()) slot.update.is_read = true;  // it was dropped: there is nothing to read
    if (slot.copy.size_bytes() < events_.size_bytes() + instance_bytes_) {
        slot.copy = make_copy();
        slot.update.is_read = true;  // its content is lost
    }
    slot.done.reset();
    std::swap(slot.before, slot.update);  // end() fills the memory of the older one
    slot.update.number = ++update_count_;
    slot.update.is_read = false;
    slot.update.watched.clear();
    slot.update.runs.batches.clear();
    slot.update.runs.runs.clear();
    slot.update.poses.clear();
    record_fill(*gpu_, commands, BufferRange(events_, 0, sizeof(io::EventHead)), 0);
}

void FeedbackRing::discard() {
    Slot& slot = last_slot();
    std::swap(slot.before, slot.update);
    slot.done.set();  // as it was: the update before it is done, or was dropped
    --update_count_;
}

void FeedbackRing::restart(uint64_t update_count) {
    for (Slot& slot : slots_) slot.update = slot.before = {};
    update_count_ = update_count;
}

// The events that a native update has written. Only these are copied, so the rest of the room takes no memory.
BufferRange FeedbackRing::happened() const {
    io::EventHead head;
    std::memcpy(&head, events_.mapped(), sizeof head);
    return {events_, 0, sizeof head + std::min(head.count, event_capacity_) * sizeof(io::EventRecord)};
}

void FeedbackRing::end(VkCommandBuffer commands, std::span<const Watched> watched, const WatchedRuns& runs,
                       std::vector<RequestedPose> poses) {
    Slot& slot = last_slot();
    memory_barrier(*gpu_, commands, kShaderWrite | kTransferWrite, kTransferRead | kTransferWrite);
    copies_.assign(1, {commands ? BufferRange(events_) : happened(), 0});
    VkDeviceSize at = events_.size_bytes();
    const auto copy = [&](BufferRange range, uint64_t offset_bytes, uint64_t size_bytes) {
        range.offset_bytes += offset_bytes;
        range.size_bytes = size_bytes;
        copies_.push_back({range, at});
        at += size_bytes;
    };
    for (const auto part_of : kWatchedParts)
        for (const WatchedRun& run : runs.runs) {
            const auto& [instances, instance_bytes] = runs.batches[run.batch].*part_of;
            if (instance_bytes > 0) copy(instances, run.first * instance_bytes, run.count * instance_bytes);
        }
    for (const RequestedPose& pose : poses)
        if (pose.skin.size_bytes > 0) copy(pose.skin, 0, pose.skin.size_bytes);  // 0: a character without palette
    record_copies(*gpu_, commands, copies_, slot.copy);
    slot.update.watched.assign(watched.begin(), watched.end());
    slot.update.runs = runs;
    slot.update.poses = std::move(poses);
    slot.done.record_set(commands);
}

std::vector<Feedback> FeedbackRing::take() {
    std::vector<Feedback> taken;
    for (Slot& slot : slots_) {
        if (slot.update.number == 0 || slot.update.is_read || !slot.done.is_set()) continue;
        taken.push_back(read(slot));
        slot.update.is_read = true;
    }
    std::sort(taken.begin(), taken.end(), [](const Feedback& a, const Feedback& b) { return a.update < b.update; });
    return taken;
}

// Invocations append events in any order. They are sorted, so that the same update always reports the same.
Feedback FeedbackRing::read(const Slot& slot) const {
    io::EventHead head;
    std::memcpy(&head, slot.copy.mapped(), sizeof head);
    std::vector<io::EventRecord> records(std::min(head.count, event_capacity_));
    if (!records.empty())
        std::memcpy(records.data(), slot.copy.mapped() + sizeof head, records.size() * sizeof(io::EventRecord));
    std::sort(records.begin(), records.end(), [](const io::EventRecord& a, const io::EventRecord& b) {
        return std::tie(a.instance, a.layer, a.time_s, a.event) < std::tie(b.instance, b.layer, b.time_s, b.event);
    });
    Feedback feedback;
    feedback.update = slot.update.number;
    feedback.lost_event_count = head.count - records.size();
    feedback.events.reserve(records.size());
    for (const io::EventRecord& record : records)
        feedback.events.push_back({{record.instance}, record.event, record.layer, record.time_s});
    const std::byte* at = slot.copy.mapped() + events_.size_bytes();
    read_watched(slot, at, feedback);
    read_poses(slot, at, feedback);
    return feedback;
}

// The arrays are filled before anything refers to them.
void FeedbackRing::read_watched(const Slot& slot, const std::byte*& at, Feedback& feedback) {
    Feedback::Arrays& arrays = feedback.arrays;
    std::vector<uint32_t> motion_counts;  // of each layer
    const auto& [batches, runs] = slot.update.runs;
    std::array<const std::byte*, kWatchedParts.size()> next_of_parts{};
    for (size_t part = 0; part < kWatchedParts.size(); ++part) {
        next_of_parts[part] = at;
        for (const WatchedRun& run : runs) at += run.count * (batches[run.batch].*kWatchedParts[part]).instance_bytes;
    }
    auto& [placement, root, socket_bytes, parameter_bytes, layer_bytes] = next_of_parts;
    const auto take = [](const std::byte*& from, void* into, uint64_t size_bytes) {
        if (size_bytes > 0) std::memcpy(into, from, size_bytes);
        from += size_bytes;
    };
    const auto append = [&](const std::byte*& from, auto& array, uint64_t size_bytes) {
        const size_t before = array.size();
        array.resize(before + size_bytes / sizeof(array[0]));
        take(from, array.data() + before, size_bytes);
    };
    feedback.watched.resize(slot.update.watched.size());
    size_t index = 0;
    for (const WatchedRun& run : runs) {
        const WatchedBatch& batch = batches[run.batch];
        append(socket_bytes, arrays.sockets, run.count * batch.sockets.instance_bytes);
        append(parameter_bytes, arrays.parameters, run.count * batch.parameters.instance_bytes);
        for (const size_t end = index + run.count; index < end; ++index) {
            WatchedInstance& watched = feedback.watched[index];
            watched.instance = {slot.update.watched[index].instance};
            io::RootState state{.move = {0, 0, 1, 0}};
            take(placement, &watched.world_from_model, batch.placements.instance_bytes);
            take(root, &state, batch.roots.instance_bytes);
            watched.move = over_the_ground(state.move);
            for (const LayerKind& kind : batch.layer_kinds) {
                io::LayerState layer;
                take(layer_bytes, &layer, sizeof layer);
                append_played(arrays.motions, layer, kind, batch.clip_count);
                motion_counts.push_back(layer.play_count);
                arrays.layer_weights.push_back(layer.weight);
            }
        }
    }
    size_t motion = 0, socket = 0, parameter = 0, layer = 0;
    for (const uint32_t count : motion_counts) {
        arrays.layers.emplace_back(arrays.motions.data() + motion, count);
        motion += count;
    }
    index = 0;
    for (const WatchedRun& run : runs) {
        const WatchedBatch& batch = batches[run.batch];
        const auto next = [](const auto& array, size_t& first, uint64_t count) {
            return std::span(array).subspan(std::exchange(first, first + count), count);
        };
        for (const size_t end = index + run.count; index < end; ++index) {
            WatchedInstance& watched = feedback.watched[index];
            watched.sockets = next(arrays.sockets, socket, batch.sockets.instance_bytes / sizeof(Affine));
            watched.parameters = next(arrays.parameters, parameter, batch.parameters.instance_bytes / sizeof(float));
            watched.layer_weights = std::span(arrays.layer_weights).subspan(layer, batch.layer_kinds.size());
            watched.layers = next(arrays.layers, layer, batch.layer_kinds.size());
        }
    }
    const auto place_of = [&](uint32_t i) { return slot.update.watched[i].place; };
    std::vector<uint32_t> order(feedback.watched.size());
    std::iota(order.begin(), order.end(), 0u);
    if (std::ranges::is_sorted(order, {}, place_of)) return;
    std::ranges::sort(order, {}, place_of);
    std::vector<WatchedInstance> as_asked;
    as_asked.reserve(order.size());
    for (const uint32_t i : order) as_asked.push_back(feedback.watched[i]);
    feedback.watched = std::move(as_asked);
}

void FeedbackRing::read_poses(const Slot& slot, const std::byte*& at, Feedback& feedback) {
    std::vector<Trs<float>>& joints = feedback.arrays.joints;
    for (const RequestedPose& pose : slot.update.poses) {
        pose.pose_of_skin->append(unpack_skin(pose.skin_format, {at, pose.skin.size_bytes}), joints);
        at += pose.skin.size_bytes;
    }
    size_t first = 0;
    for (const RequestedPose& pose : slot.update.poses) {
        const size_t count = pose.pose_of_skin->joint_count();
        feedback.poses.push_back({{pose.instance}, std::span(joints).subspan(first, count)});
        first += count;
    }
}

uint64_t FeedbackRing::size_bytes() const {
    uint64_t sum = events_.size_bytes();
    for (const Slot& slot : slots_) sum += slot.copy.size_bytes();
    return sum;
}

}  // namespace throng
