// Compute pipelines that are made once a device and shared.
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <map>
#include <memory>
#include <mutex>
#include <vector>

namespace throng {

struct CompiledKernel;  // gpu/kernel.cpp

// Those in use are found by what they were made of. Thread-safe.
class SharedKernels {
public:
    // Everything that the pipeline depends on.
    using Key = std::vector<uint32_t>;
    using Shared = std::shared_ptr<const CompiledKernel>;

    // Of those that nobody uses any more, how many stay: a crowd that is made anew, a little changed, compiles little.
    static constexpr size_t kKept = 64;
    // None stays where `kept` is 0: the device may go before this does.
    explicit SharedKernels(size_t kept) : kept_count_(kept) {}

    // Null where there is none.
    Shared find(const Key& key);
    // Returns the one to use: that of another thread, where it was faster.
    Shared add(Key key, const Shared& made);
    void clear();

private:
    void keep(const Shared& used);

    std::mutex mutex_;
    std::map<Key, std::weak_ptr<const CompiledKernel>> by_key_;
    size_t kept_count_;
    std::deque<Shared> kept_;  // the one asked for last is the last
};

}  // namespace throng
