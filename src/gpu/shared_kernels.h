// Compute pipelines that are made once per device and shared.
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <map>
#include <memory>
#include <mutex>
#include <span>
#include <vector>

namespace throng {

class CompiledKernel;  // gpu/kernel.cpp

// Looks up pipelines in use by the code and settings that they were made from. Thread-safe.
class SharedKernels {
public:
    // Everything that the pipeline depends on. Code is compared by its words, but not copied: a large kernel has 100
    // KB.
    struct Key {
        std::span<const uint32_t> code;  // static
        std::vector<uint32_t> settings;
        bool operator<(const Key& other) const;
    };
    using Shared = std::shared_ptr<const CompiledKernel>;

    // How many pipelines are kept after their last user is gone, so that making a crowd again, with small changes,
    // compiles little.
    static constexpr size_t kKept = 256;
    // `kept` is 0 for devices of the application, which it may destroy before this object.
    explicit SharedKernels(size_t kept) : kept_count_(kept) {}

    // Null where there is none.
    Shared find(const Key& key);
    // Returns the kernel to use: another thread's if that was added first.
    Shared add(Key key, const Shared& made);
    // Without those that are only kept for reuse.
    std::vector<Shared> in_use();
    void clear();

private:
    void keep(const Shared& used);

    std::mutex mutex_;
    std::map<Key, std::weak_ptr<const CompiledKernel>> by_key_;
    size_t kept_count_;
    std::deque<Shared> kept_;  // most recently used last
};

}  // namespace throng
