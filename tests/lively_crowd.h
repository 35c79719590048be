// Crowds that use many features, and all results of their updates, bit for bit.
#pragma once

#include "tests/crowd_cases.h"

#include <cstddef>
#include <span>
#include <vector>

namespace throng::test {

Device native_device(DeviceSettings settings = {});

// A creature that walks ahead in each of its clips.
Character walking_creature();

// Characters that play two clips, with many instances of one of them, and two with controllers, events and sockets: one
// with root motion, one with inertial transitions.
struct LivelyCrowd {
    MixedCrowd mixed{0.1};
    Character walking = walking_creature(), flying = creature(90, 25);
    Controller walker = example("walker"), dragon = example("dragon");
    CrowdSettings settings = mixed.settings;
    uint32_t first_walking, first_flying, first_of_many, instance_count;
    std::vector<InstanceHandle> watched;

    LivelyCrowd(uint32_t walking_count, uint32_t flying_count, uint32_t many_count);
    LivelyCrowd(const LivelyCrowd&) = delete;

    double size_of(uint32_t instance) const;
    Crowd create_on(const Device& device, UpdatePath path) const;
    // Makes the same calls for every crowd in its update with this number.
    void update(Crowd& crowd, uint32_t update, const CrowdView* view = nullptr) const;
};

Feedback feedback_of(Crowd& crowd);

bool same_events(const Feedback& a, const Feedback& b, float max_apart_s = 0);

// A view from above that sees all within a box.
CrowdView view_of_box(const Vec3<float>& middle, float half);

// Collects the results of updates as bytes, to compare them.
class UpdateBits {
public:
    template <class Values>
    void add(const Values& values) {
        const auto bytes = std::as_bytes(std::span(values));
        all.insert(all.end(), bytes.begin(), bytes.end());
    }
    // Member by member, since the struct has padding.
    void add(std::span<const PlayedMotion> played);
    // The outputs of a crowd on a native device, as its last update left them.
    void add_results(Crowd& crowd);
    void add_feedback(Crowd& crowd);
    void add_drawn(Crowd& crowd);

    std::vector<std::byte> all;
};

std::vector<std::byte> bits_of(const LivelyCrowd& lively, const Device& device, UpdatePath path, uint32_t updates = 12);

}  // namespace throng::test
