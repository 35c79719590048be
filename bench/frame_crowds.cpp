#include "bench/frame_crowds.h"

#include "control/control_io.h"
#include "crowd/staged_update.h"

#include <algorithm>

namespace throng::bench {

std::shared_ptr<const FrameCrowd> FrameCrowds::get(const FrameCrowdKey& key) {
    for (const auto& existing : crowds_)
        if (existing->key == key) return existing;
    FrameCrowd made{.key = key, .crowd = nullptr, .unsupported_reason = memory_unsupported_reason(needed_bytes(key))};
    if (made.unsupported_reason.empty()) {
        Result<Crowd> crowd = Crowd::create(
            device_, {.groups = {{key.character, instance_count_}}, .path = key.path, .skin_format = key.format});
        if (crowd)
            made.crowd = std::make_unique<Crowd>(std::move(*crowd));
        else
            made.unsupported_reason = crowd.error().text();
    }
    return crowds_.emplace_back(std::make_shared<const FrameCrowd>(std::move(made)));
}

std::string FrameCrowds::memory_unsupported_reason(uint64_t needed_bytes) const {
    const uint64_t heap_bytes = device_.gpu()->largest_heap_bytes();
    uint64_t held_bytes = 0;
    for (const auto& existing : crowds_)
        if (existing->crowd) held_bytes += existing->crowd->size_bytes();
    if (held_bytes + needed_bytes <= heap_bytes) return {};
    return std::to_string(needed_bytes >> 20) + " MiB do not fit into the device's memory of " +
           std::to_string(heap_bytes >> 20) + " MiB, of which other variants use " + std::to_string(held_bytes >> 20) +
           " MiB";
}

uint64_t FrameCrowds::arena_buffer_bytes(const Character& character) const {
    return std::min(arena_limit_bytes(*device_.gpu()),
                    uint64_t{instance_count_} * character.rig.joint_count() * sizeof(Affine));
}

uint64_t FrameCrowds::needed_bytes(const FrameCrowdKey& key) const {
    constexpr uint64_t kArenaBuffers = 4,
                       kState_bytes = sizeof(io::InstancePlayback) + sizeof(io::InstanceCursor) + sizeof(Affine);
    const uint64_t instance_bytes = key.character->palette.size() * uint64_t{skin_format_bytes(key.format)} +
                                    kState_bytes;
    return instance_count_ * instance_bytes +
           (key.path == UpdatePath::kStaged ? kArenaBuffers * arena_buffer_bytes(*key.character) : 0);
}

}  // namespace throng::bench
