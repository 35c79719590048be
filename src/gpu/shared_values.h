// Results of expensive computations, shared on a device, or in a renderer, by all that have the same inputs.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <utility>
#include <vector>

namespace throng {

enum class SharedValue : uint64_t { kNativeRig, kGroupRows, kImage, kPicture, kTexture, kNativeTexture };

// Looks up values in use by what they were computed from. Thread-safe.
class SharedValues {
public:
    // A SharedValue, and all that it depends on.
    using Key = std::vector<uint64_t>;

    // make() returns a T.
    template <class T, class Make>
    std::shared_ptr<const T> get(const Key& key, const Make& make) {
        if (auto found = find<T>(key)) return found;
        return add<T>(key, std::make_shared<const T>(make()));
    }
    // Null where there is none.
    template <class T>
    std::shared_ptr<const T> find(const Key& key) {
        const std::lock_guard lock(mutex_);
        const auto found = by_key_.find(key);
        return found == by_key_.end() ? nullptr : std::static_pointer_cast<const T>(found->second.lock());
    }
    // Returns the value to use: another thread's if that was added first. It is not kept alive.
    template <class T>
    std::shared_ptr<const T> add(Key key, std::shared_ptr<const T> made) {
        const std::lock_guard lock(mutex_);
        std::erase_if(by_key_, [](const auto& entry) { return entry.second.expired(); });
        const auto entry = by_key_.try_emplace(std::move(key), made).first;
        if (const auto found = entry->second.lock()) return std::static_pointer_cast<const T>(found);
        entry->second = made;
        return made;
    }

private:
    std::mutex mutex_;
    std::map<Key, std::weak_ptr<const void>> by_key_;
};

}  // namespace throng
