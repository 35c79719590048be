// The crowds of one case of `throng bench frame`: all of them alive at once, since they are timed in turns, as far as
// memory goes.
#pragma once

#include <throng/crowd.h>

#include <memory>
#include <string>
#include <vector>

namespace throng::bench {

struct FrameCrowdKey {
    const Character* character = nullptr;
    UpdatePath path = UpdatePath::kAuto;
    SkinFormat format = SkinFormat::kAffine;
    bool operator==(const FrameCrowdKey&) const = default;
};

struct FrameCrowd {
    FrameCrowdKey key;
    std::unique_ptr<Crowd> crowd;  // none where `unsupported_reason` says why
    std::string unsupported_reason;
};

class FrameCrowds {
public:
    FrameCrowds(const Device& device, uint32_t instance_count) : device_(device), instance_count_(instance_count) {}

    // The same one for the same key: variants that differ in what is played share it.
    std::shared_ptr<const FrameCrowd> get(const FrameCrowdKey& key);

    // Why so much does not fit the device's memory beside these crowds; empty where it does. A driver that gives more
    // than it has, as lavapipe does, would swap or be killed.
    std::string memory_unsupported_reason(uint64_t needed_bytes) const;

    // Size of one of the staged update's intermediates.
    uint64_t arena_buffer_bytes(const Character& character) const;

private:
    uint64_t needed_bytes(const FrameCrowdKey& key) const;

    const Device& device_;
    uint32_t instance_count_;
    std::vector<std::shared_ptr<const FrameCrowd>> crowds_;
};

}  // namespace throng::bench
