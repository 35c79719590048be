// Which instances a call is about; instances that come and go.
#pragma once

#include <throng/index.h>

#include <concepts>
#include <cstdint>
#include <span>

namespace throng {

// Identifies an instance from its Crowd::spawn() to its Crowd::despawn(). Outputs are indexed by its number in the
// crowd, which is later given to other instances, with another generation. In groups without CrowdGroup::capacity that
// were made with the crowd, the generation is 0. Crowd::restore_state() restores generations too: forget the handles
// received since that state was saved, for they may name other instances.
struct InstanceHandle {
    uint32_t instance = kNone;
    uint32_t generation = 0;  // differs between instances that have the number one after another; modulo 2^32

    bool operator==(const InstanceHandle&) const = default;
};

// The instances that a call is about: one or many, in a given order. Refers to the caller's handles, which must last as
// long as the call. If one of the instances is gone, the call does nothing and says which.
class Instances {
public:
    Instances(const InstanceHandle& one) : handles_(&one), count_(1) {}
    Instances(std::span<const InstanceHandle> handles)
        : handles_(handles.data()), count_(static_cast<uint32_t>(handles.size())) {}
    template <class Range>
    requires std::convertible_to<const Range&, std::span<const InstanceHandle>> Instances(const Range& handles)
        : Instances(std::span<const InstanceHandle>(handles)) {}
    // The instances that have the `count` numbers from `first` on at the time of the call that is given this.
    static Instances numbered(uint32_t first, uint32_t count = 1) {
        Instances instances{std::span<const InstanceHandle>()};
        instances.first_ = first;
        instances.count_ = count;
        return instances;
    }

    uint32_t size() const { return count_; }
    const InstanceHandle* handles() const { return handles_; }  // [size()]; null: numbers from first() on
    uint32_t first() const { return first_; }
    uint32_t number(uint32_t i) const { return handles_ ? handles_[i].instance : first_ + i; }

private:
    const InstanceHandle* handles_ = nullptr;
    uint32_t first_ = 0, count_ = 0;
};

}  // namespace throng
