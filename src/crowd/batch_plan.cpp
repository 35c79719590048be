#include "crowd/batch_plan.h"

#include <algorithm>
#include <cstring>
#include <utility>

namespace throng {
namespace {

// The state that inertial transitions of one instance keep between native updates.
uint64_t inertia_bytes(const Group& group) {
    const bool is_inertial = group.native_rig() && group.controller && group.controller->is_inertial;
    return is_inertial ? group.native_rig()->inertia_floats() * sizeof(float) : 0;
}

}  // namespace

void BatchPlan::add(uint32_t number, uint64_t instance_bytes, Make make) {
    limit(instance_bytes);
    entries_.push_back({number, instance_bytes, std::move(make)});
}

void BatchPlan::add_of_batch(uint32_t number, uint64_t max_bytes, Make make) {
    batch_bytes_ += max_bytes * buffer_count(number);
    entries_.push_back({number, 0, std::move(make)});
}

void BatchPlan::add_storage(uint32_t number, uint64_t instance_bytes) {
    add(number, instance_bytes, [=](Uploads& uploads, const std::string& what, uint64_t n) {
        return Buffer(uploads.gpu(), what, n * instance_bytes, VK_BUFFER_USAGE_STORAGE_BUFFER_BIT);
    });
}

void BatchPlan::add_zeros(uint32_t number, uint64_t instance_bytes) {
    add(number, instance_bytes, [=](Uploads& uploads, const std::string& what, uint64_t n) {
        Buffer buffer(uploads.gpu(), what, n * instance_bytes, VK_BUFFER_USAGE_STORAGE_BUFFER_BIT);
        uploads.add(buffer, {});
        return buffer;
    });
}

uint64_t BatchPlan::instance_bytes() const {
    uint64_t sum = inertia_bytes(group_);
    for (const Entry& entry : entries_) sum += entry.instance_bytes * buffer_count(entry.number);
    return sum;
}

bool BatchPlan::is_only_in_slots(uint32_t number) const {
    return number == io::kSkinBuffer || (number == io::kSkinnedBuffer && settings_.frames_in_flight > 1);
}

bool BatchPlan::is_copied_to_slots(uint32_t number) const {
    return settings_.frames_in_flight > 1 && std::ranges::count(kShownBuffers, number) > 0;
}

uint64_t BatchPlan::buffer_count(uint32_t number) const {
    const uint64_t slots = frame_slot_count(settings_);
    return is_only_in_slots(number) ? slots : is_copied_to_slots(number) ? 1 + slots : 1;
}

void BatchPlan::make(Uploads& uploads, Batch& batch) const {
    if (batch.inertia_bytes = batch.instance_count * inertia_bytes(group_); batch.inertia_bytes > 0) {
        batch.inertia_states = native::aligned_bytes(batch.inertia_bytes);
        std::memset(batch.inertia_states.get(), 0, batch.inertia_bytes);
    }
    batch.skins.resize(frame_slot_count(settings_));
    if (settings_.frames_in_flight > 1) batch.shown.resize(batch.skins.size());
    for (const Entry& entry : entries_) {
        const auto make_one = [&] {
            const std::string what = group_.name + ": " + std::string(name_of_buffer(entry.number));
            return entry.make(uploads, what, batch.instance_count);
        };
        if (entry.number == io::kSkinBuffer) {
            for (Buffer& skin : batch.skins) skin = make_one();
            continue;
        }
        if (!is_only_in_slots(entry.number)) batch[entry.number] = make_one();
        if (is_only_in_slots(entry.number) || is_copied_to_slots(entry.number))
            for (Buffers& shown : batch.shown) shown[entry.number] = make_one();
    }
}

}  // namespace throng
