// The crowds of one case of `throng bench frame`. As they are timed in turns, as many as fit into memory are alive at
// once.
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
    std::unique_ptr<Crowd> crowd;  // null: `unsupported_reason` says why
    std::string unsupported_reason;
};

class FrameCrowds {
public:
    FrameCrowds(const Device& device, uint32_t instance_count) : device_(device), instance_count_(instance_count) {}

    // The same crowd for the same key: variants that differ only in what is played share it.
    std::shared_ptr<const FrameCrowd> get(const FrameCrowdKey& key);

    // Why `needed_bytes` do not fit the device's memory beside these crowds; empty if they do. A driver may allocate
    // more memory than there is, as lavapipe does; then the process would swap or be killed.
    std::string memory_unsupported_reason(uint64_t needed_bytes) const;

    // Size of one of the intermediate buffers of the staged update.
    uint64_t arena_buffer_bytes(const Character& character) const;

private:
    uint64_t needed_bytes(const FrameCrowdKey& key) const;

    const Device& device_;
    uint32_t instance_count_;
    std::vector<std::shared_ptr<const FrameCrowd>> crowds_;
};

}  // namespace throng::bench
