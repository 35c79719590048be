#include "crowd/batch_plan.h"

#include <algorithm>
#include <utility>

namespace throng {

void BatchPlan::add(uint32_t number, uint64_t instance_bytes, Make make) {
    limit(instance_bytes);
    entries_.push_back({number, instance_bytes, std::move(make)});
}

void BatchPlan::add_of_batch(uint32_t number, uint64_t most_bytes, Make make) {
    batch_bytes_ += most_bytes * buffer_count(number);
    entries_.push_back({number, 0, std::move(make)});
}

void BatchPlan::add_storage(uint32_t number, uint64_t instance_bytes) {
    add(number, instance_bytes, [=](Uploads& uploads, const std::string& what, uint64_t n) {
        return Buffer(uploads.gpu(), what, n * instance_bytes, VK_BUFFER_USAGE_STORAGE_BUFFER_BIT);
    });
}

uint64_t BatchPlan::instance_bytes() const {
    uint64_t sum = unbuffered_bytes_;
    for (const Entry& entry : entries_) sum += entry.instance_bytes * buffer_count(entry.number);
    return sum;
}

uint64_t BatchPlan::buffer_count(uint32_t number) const {
    const uint64_t slots = frame_slot_count(settings_);
    if (number == io::kSkinBuffer) return slots;
    if (settings_.frames_in_flight == 1) return 1;
    if (number == io::kSkinnedBuffer) return slots;
    return std::ranges::count(kShownBuffers, number) ? 1 + slots : 1;
}

void BatchPlan::make(Uploads& uploads, Batch& batch) const {
    const uint32_t slots = frame_slot_count(settings_);
    if (settings_.frames_in_flight > 1) batch.shown.resize(slots);
    for (const Entry& entry : entries_) {
        const uint32_t number = entry.number;
        const auto make_one = [&] {
            const std::string what = group_.name + ": " + std::string(name_of_buffer(number));
            return entry.make(uploads, what, batch.instance_count);
        };
        const uint64_t count = buffer_count(number);
        if (number == io::kSkinBuffer) {
            while (batch.skins.size() < count) batch.skins.push_back(make_one());
            continue;
        }
        if (count != slots || count == 1) batch[number] = make_one();
        if (count > 1)
            for (Buffers& slot : batch.shown) slot[number] = make_one();
    }
}

}  // namespace throng
