#include "gpu/shared_kernels.h"

#include <algorithm>

namespace throng {

bool SharedKernels::Key::operator<(const Key& other) const {
    if (settings != other.settings) return settings < other.settings;
    const bool is_same_memory = code.data() == other.code.data() && code.size() == other.code.size();
    return !is_same_memory && std::ranges::lexicographical_compare(code, other.code);
}

SharedKernels::Shared SharedKernels::find(const Key& key) {
    const std::lock_guard lock(mutex_);
    const auto found = by_key_.find(key);
    Shared shared = found != by_key_.end() ? found->second.lock() : nullptr;
    if (shared) keep(shared);
    return shared;
}

SharedKernels::Shared SharedKernels::add(Key key, const Shared& made) {
    const std::lock_guard lock(mutex_);
    std::erase_if(by_key_, [](const auto& entry) { return entry.second.expired(); });
    const auto entry = by_key_.try_emplace(std::move(key), made).first;
    Shared shared = entry->second.lock();
    if (!shared) entry->second = shared = made;
    keep(shared);
    return shared;
}

std::vector<SharedKernels::Shared> SharedKernels::in_use() {
    const std::lock_guard lock(mutex_);
    std::vector<Shared> found;
    for (const auto& [key, weak] : by_key_) {
        Shared shared = weak.lock();
        const auto own_count = 1 + std::ranges::count(kept_, shared);
        if (shared && shared.use_count() > own_count) found.push_back(std::move(shared));
    }
    return found;
}

void SharedKernels::keep(const Shared& used) {
    std::erase(kept_, used);
    kept_.push_back(used);
    while (kept_.size() > kept_count_) kept_.pop_front();
}

void SharedKernels::clear() {
    const std::lock_guard lock(mutex_);
    kept_.clear();
}

}  // namespace throng
