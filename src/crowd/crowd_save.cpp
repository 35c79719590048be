// The state of a crowd as bytes, and back: a head, what the buffers of batches hold, the state that the CPU keeps, and
// a checksum.
#include "base/crc64.h"
#include "base/failure.h"
#include "crowd/crowd_state.h"
#include "crowd/state_archive.h"
#include "crowd/state_checks.h"
#include "gpu/barrier.h"

#include <algorithm>

namespace throng {
namespace {

constexpr uint64_t kMagic = 0x6574617473676874;  // "thgstate"
constexpr uint32_t kVersion = 8;

struct Head {
    uint64_t magic = kMagic;
    uint32_t version = kVersion;
    uint32_t flags = 0;
    StateFit fit{};
    uint64_t buffers_bytes = 0;
};
constexpr uint32_t kHasUpdated = 1, kWasNative = 2;

// A checksum of values that are added one after another.
class Checksum {
public:
    template <class T>
    void add(const T& value) {
        static_assert(std::has_unique_object_representations_v<T> || std::is_floating_point_v<T>);
        crc_ = crc64(std::as_bytes(std::span(&value, 1)), crc_);
    }
    template <class T>
    void add_all(const T& values) {
        add(uint64_t{std::size(values)});
        crc_ = crc64(std::as_bytes(std::span(values)), crc_);
    }
    uint64_t value() const { return crc_; }

private:
    uint64_t crc_ = 0;
};

void add_controller(Checksum& made_of, const GroupController& controller) {
    made_of.add(controller.parameter_count);
    made_of.add(controller.active_clip_limit);
    made_of.add_all(controller.initial_layers);
    made_of.add_all(controller.initial_parameters);
    made_of.add_all(controller.masks);
    for (const LayerKind& kind : controller.layer_kinds) made_of.add(kind.state_count);
    made_of.add(controller.checksum);
}

void add_path(Checksum& paths, const Group& group) {
    paths.add(uint32_t{group.native});
    paths.add(uint64_t{group.fused.size()});
    paths.add_all(group.scan_choice.method->name);
}

void add_group(Checksum& made_of, const Group& group) {
    made_of.add_all(group.name);
    made_of.add_all(group.parents);
    made_of.add_all(group.clip_durations_s);
    made_of.add(group.names_checksum);
    made_of.add(group.palette_count);
    made_of.add(uint32_t{group.varies});
    made_of.add(uint32_t{group.packed});
    made_of.add(uint32_t{group.rows != nullptr});
    made_of.add(uint32_t{group.moves_placements()});
    made_of.add(uint32_t{group.is_carried});
    made_of.add(group.command_capacity);
    made_of.add(uint32_t{group.shaders_populate});
    if (group.sockets) made_of.add_all(group.sockets->joints);
    made_of.add(static_cast<uint32_t>(group.socket_space));
    made_of.add(group.pose_capacity);
    made_of.add(group.outfit_count);
    made_of.add(group.active_morph_limit);
    made_of.add_all(std::array{group.posed_min, group.posed_max});  // they decide which instances are in view
    if (group.controller) add_controller(made_of, *group.controller);
    if (group.procedural) made_of.add(group.procedural->checksum);
    if (group.steering) {
        made_of.add_all(std::array{group.steering->radius, group.steering->speed, group.steering->turn});
        made_of.add(group.steering->speed_parameter);
    }
}

// The first difference; empty if there is none.
std::string_view difference(const StateFit& saved, const StateFit& current) {
    if (saved.settings != current.settings)
        return "CrowdSettings::skin_format, keep_previous_matrices or culling differs";
    if (saved.groups != current.groups) return "a group's character, controller or another CrowdGroup setting differs";
    if (saved.counts != current.counts) return "a group's instance_count or capacity differs";
    if (saved.paths != current.paths)
        return "groups are updated in another way (natively or on a device, CrowdSettings::path, scan)";
    if (saved.buffers != current.buffers) return "other settings differ, and give buffers other sizes";
    return "";
}

}  // namespace

StateFit CrowdState::state_fit() const {
    Checksum paths, settings, made_of, counts, buffers;
    paths.add(uint32_t{gpu->is_native()});
    settings.add(static_cast<uint32_t>(skin_format));
    settings.add(uint32_t{keeps_previous_});
    settings.add(uint32_t{cull != nullptr});
    for (uint32_t group = 0; group < groups.size(); ++group) {
        if (groups[group].is_gone()) continue;
        add_path(paths, groups[group]);
        made_of.add(group);
        add_group(made_of, groups[group]);
    }
    for (const Batch& batch : batches) {
        counts.add(batch.first_instance);
        counts.add(batch.instance_count);
    }
    for (const KeptBuffer& kept : kept_buffers()) {
        buffers.add(kept.number);
        buffers.add(kept.buffer->size_bytes());
    }
    return {paths.value(), settings.value(), made_of.value(), counts.value(), buffers.value()};
}

std::vector<CrowdState::KeptBuffer> CrowdState::kept_buffers() const {
    std::vector<KeptBuffer> kept;
    for (const Batch& batch : batches) {
        for (const uint32_t number : kSavedBuffers)
            if (batch[number]) kept.push_back({&batch, number, &batch[number]});
        if (groups[batch.group].shaders_populate)
            kept.push_back({&batch, io::kBirthsBuffer, &batch[io::kBirthsBuffer]});
        if (keeps_previous_ || batch[io::kSkinTargetBuffer]) kept.push_back({&batch, io::kSkinBuffer, &batch.skin()});
    }
    return kept;
}

void CrowdState::exchange(StateArchive& archive) {
    archive.value(full_rate_factor_);
    StateArchive::require(full_rate_factor_ >= 1 && full_rate_factor_ <= kMaxFullRateFactor,
                          "the budget's factor is out of range");
    for (const auto& stage : stages) stage->exchange(archive);
    for (uint32_t group = 0; group < groups.size(); ++group)
        for (const auto& stage : stages)
            if (!groups[group].is_gone()) stage->exchange_group(archive, group);
    for (Batch& batch : batches) {
        archive.value(batch.has_updated);
        archive.values(std::span(batch.inertia_states.get(), batch.inertia_bytes));
    }
    std::vector<Watched> in_call_order = watched_;
    std::ranges::sort(in_call_order, {}, &Watched::place);
    std::vector<uint32_t> watched;
    for (const Watched& one : in_call_order) watched.push_back(one.instance);
    archive.list(watched, UINT32_MAX);  // an instance may be watched twice; the capacity is checked below
    if (watched.size() > watch_capacity_)
        throw Failure(ErrorCode::kInvalidArgument, "crowd state", "it does not fit this crowd: it has ", watched.size(),
                      " watched instances, but CrowdSettings::watch_capacity is ", watch_capacity_);
    archive.list(pose_requests_, UINT32_MAX);
    // Twice the capacity: discard_last_record() puts the requests of its update back, in front of newer ones.
    if (pose_requests_.size() > 2 * uint64_t{pose_request_capacity_})
        throw Failure(ErrorCode::kInvalidArgument, "crowd state", "it does not fit this crowd: it has ",
                      pose_requests_.size(),
                      " requested poses, more than twice CrowdSettings::pose_request_capacity, which is ",
                      pose_request_capacity_);
    if (!archive.reads()) return;
    recorded_pose_requests_.clear();
    std::vector<InstanceHandle> handles;
    for (const uint32_t instance : watched) {
        StateArchive::require(instance < instance_count && has_instance(instance), "a watched instance is not alive");
        handles.push_back(handle(instance));
    }
    if (feedback) watch(handles);
    for (const uint32_t instance : pose_requests_)
        StateArchive::require(instance < instance_count && has_instance(instance) && group_of(instance).pose_of_skin,
                              "a pose is requested of an instance that is not alive, or whose group has no "
                              "CrowdGroup::pose_capacity");
}

// Saves zeros as the playbacks of a crowd that has not been updated: the first update writes them all.
void CrowdState::clear_playbacks(std::span<const KeptBuffer> kept, std::span<std::byte> contents) {
    for (const auto& [batch, number, buffer] : kept) {
        if (number == io::kPlaybacksBuffer) std::ranges::fill(contents.first(buffer->size_bytes()), std::byte{});
        contents = contents.subspan(buffer->size_bytes());
    }
}

void CrowdState::save_state(std::vector<std::byte>& out) {
    check_may_change("crowd state");
    check_last_has_run("crowd state");
    finish_uploads();
    const std::vector<KeptBuffer> kept = kept_buffers();
    Head head{.flags = (has_updated_ ? kHasUpdated : 0) | (was_native_ ? kWasNative : 0), .fit = state_fit()};
    for (const KeptBuffer& one : kept) head.buffers_bytes += one.buffer->size_bytes();
    StateArchive archive;
    archive.write_into(std::move(out));
    constexpr uint64_t kHostBytes = 256;  // of an instance, roughly: a larger state is reallocated as it grows
    const size_t sure_bytes = sizeof head + head.buffers_bytes;
    archive.reserve(sure_bytes + instance_count * kHostBytes, sure_bytes);
    archive.value(head);
    const std::span<std::byte> contents = archive.room_for(head.buffers_bytes);
    download_all(kept, contents);
    if (!has_updated_) clear_playbacks(kept, contents);
    exchange(archive);
    uint64_t checksum = crc64(archive.written());
    archive.value(checksum);
    out = archive.take();
}

void CrowdState::download_all(std::span<const KeptBuffer> kept, std::span<std::byte> contents) const {
    if (contents.empty()) return;
    size_t at = 0;
    if (std::ranges::all_of(kept, [](const KeptBuffer& one) { return one.buffer->mapped() != nullptr; })) {
        if (!gpu->is_native()) gpu->wait_idle();            // what was submitted may still write to the buffers
        for (const auto& [batch, number, buffer] : kept) {  // native, or memory of a software device
            std::memcpy(contents.data() + at, buffer->mapped(), buffer->size_bytes());
            at += buffer->size_bytes();
        }
        return;
    }
    const Buffer staging(gpu, "saved state", contents.size(), 0, MemoryKind::kReadback);
    gpu->submit_and_wait([&](VkCommandBuffer commands) {
        memory_barrier(*gpu, commands, kShaderWrite | kTransferWrite, kTransferRead);
        for (const auto& [batch, number, buffer] : kept) {
            record_copy(*gpu, commands, *buffer, BufferRange(staging, at, buffer->size_bytes()));
            at += buffer->size_bytes();
        }
        memory_barrier(*gpu, commands, kTransferWrite, kHostRead);
    });
    std::memcpy(contents.data(), staging.mapped(), contents.size());
}

// Checks what it can before anything changes. If an error only shows while reading, the previous state is put back.
void CrowdState::restore_state(std::span<const std::byte> state) {
    if (!is_half_recorded_) check_may_change("crowd state");
    check_last_has_run("crowd state");
    if (is_half_recorded_) discard_uploads();
    finish_uploads();
    const std::vector<KeptBuffer> kept = kept_buffers();
    uint64_t checksum = 0;
    StateArchive::require(state.size() > sizeof(Head) + sizeof checksum, "it ends too early");
    const std::span<const std::byte> checked = state.first(state.size() - sizeof checksum);
    StateArchive(state.last(sizeof checksum)).value(checksum);
    Head head;
    StateArchive(checked).value(head);
    StateArchive::require(head.magic == kMagic, "these are not bytes of Crowd::save_state()");
    StateArchive::require(head.version == kVersion, "another version of throng wrote it");
    StateArchive::require(checksum == crc64(checked), "its checksum is wrong: it has been damaged");
    if (const std::string_view differs = difference(head.fit, state_fit()); !differs.empty())
        throw Failure(ErrorCode::kInvalidArgument, "crowd state", "it does not fit this crowd: ", differs);
    uint64_t buffers_bytes = 0;
    for (const KeptBuffer& one : kept) buffers_bytes += one.buffer->size_bytes();
    const std::span<const std::byte> rest = checked.subspan(sizeof head);
    StateArchive::require(head.buffers_bytes == buffers_bytes && buffers_bytes <= rest.size(), "it ends too early");
    const std::span<const std::byte> contents = rest.first(buffers_bytes);
    size_t at = 0;
    for (const auto& [batch, number, buffer] : kept) {
        check_contents(number, contents.subspan(at, buffer->size_bytes()), groups[batch->group]);
        at += buffer->size_bytes();
    }
    const bool follows = placements->is_followed();
    StateArchive as_it_was;
    const size_t host_bytes = rest.size() - buffers_bytes;
    as_it_was.reserve(host_bytes / 4 * 5, host_bytes);  // about as much, perhaps more
    exchange(as_it_was);
    try {
        StateArchive archive(rest.subspan(buffers_bytes));
        exchange(archive);
        StateArchive::require(archive.is_at_end(), "there are bytes after its end");
    } catch (...) {
        StateArchive archive(as_it_was.written());
        exchange(archive);
        if (follows) placements->follow(false);
        throw;
    }
    upload_all(kept, contents);
    has_updated_ = had_updated_ = (head.flags & kHasUpdated) != 0;
    was_native_ = (head.flags & kWasNative) != 0;
    awaits_commands_ = can_discard_ = may_be_pending_ = is_half_recorded_ = false;
    if (feedback) feedback->restart(population->update_count());
    if (!follows) return;
    try {
        follow_placements(true);
    } catch (const Failure&) {  // the state is restored; the next updates tell where instances stand
    }
}

void CrowdState::upload_all(std::span<const KeptBuffer> kept, std::span<const std::byte> contents) const {
    if (!gpu->is_native()) gpu->wait_idle();  // what was submitted may still use the buffers
    Uploads uploads(gpu);
    size_t at = 0;
    for (const auto& [batch, number, buffer] : kept) {
        const auto of_buffer = contents.subspan(at, buffer->size_bytes());
        if (std::byte* const mapped = buffer->mapped())  // native, or memory of a software device
            std::memcpy(mapped, of_buffer.data(), of_buffer.size());
        else
            uploads.add(*buffer, of_buffer);
        at += buffer->size_bytes();
    }
    uploads.finish();
}

}  // namespace throng
