#include "crowd/batch_plan.h"

#include <algorithm>
#include <utility>

namespace throng {

void BatchPlan::add(uint32_t number, uint64_t instance_bytes, Make make) {
    limit(instance_bytes);
    entries_.push_back({number, instance_bytes, std::move(make)});
}

void BatchPlan::add_of_batch(uint32_t number, uint64_t most_bytes, Make make) {
    batch_bytes_ += most_bytes;
    entries_.push_back({number, 0, std::move(make)});
}

void BatchPlan::add_storage(uint32_t number, uint64_t instance_bytes) {
    add(number, instance_bytes, [=](Uploads& uploads, const std::string& what, uint64_t n) {
        return Buffer(uploads.gpu(), what, n * instance_bytes, VK_BUFFER_USAGE_STORAGE_BUFFER_BIT);
    });
}

uint64_t BatchPlan::instance_bytes() const {
    uint64_t sum = unbuffered_bytes_;
    for (const Entry& entry : entries_) sum += entry.instance_bytes;
    return sum;
}

void BatchPlan::make(Uploads& uploads, Batch& batch) const {
    for (const Entry& entry : entries_) {
        const std::string what = group_.name + ": " + std::string(name_of_buffer(entry.number));
        Buffer made = entry.make(uploads, what, batch.instance_count);
        // Matrices of this update and of the one before take turns.
        if (entry.number == io::kSkinBuffer)
            batch.skins[0] = std::move(made);
        else if (entry.number == io::kPreviousSkinBuffer)
            batch.skins[1] = std::move(made);
        else
            batch[entry.number] = std::move(made);
    }
}

}  // namespace throng
