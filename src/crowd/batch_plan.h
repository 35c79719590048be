// The buffers of a group's batches. Each stage adds its own (BatchPlan); then as many instances form a batch as the
// device's limits allow, and the buffers are made.
#pragma once

#include "crowd/batch.h"
#include "gpu/upload.h"

#include <functional>

namespace throng {

class BatchPlan {
public:
    using Make = std::function<Buffer(Uploads& uploads, const std::string& what, uint64_t instance_count)>;

    BatchPlan(const Group& group, const CrowdSettings& settings) : group_(group), settings_(settings) {}

    // Contents are undefined. `instance_bytes`: of one instance.
    void add_storage(uint32_t number, uint64_t instance_bytes);
    // The same, filled with zeros: what Crowd::save_state() saves must not contain leftovers of earlier memory.
    void add_zeros(uint32_t number, uint64_t instance_bytes);
    // Read by gpu/table.glsl, as T.
    template <class T>
    void add_table(uint32_t number, uint64_t count_of_instance = 1) {
        add(number, count_of_instance * sizeof(T), [=](Uploads& uploads, const std::string& what, uint64_t n) {
            return make_table<T>(uploads.gpu(), what, n * count_of_instance);
        });
    }
    // A buffer that begins with `of_instance` once for each instance.
    template <class T>
    void add_filled(uint32_t number, std::vector<T> of_instance) {
        const uint64_t instance_bytes = of_instance.size() * sizeof(T);
        add(number, instance_bytes,
            [=](Uploads& uploads, const std::string& what, uint64_t n) { return fill(uploads, what, of_instance, n); });
    }
    // The same, as a table of words that kernels also write.
    template <class T>
    void add_filled_table(uint32_t number, std::vector<T> of_instance) {
        const uint64_t instance_bytes = of_instance.size() * sizeof(T);
        add(number, instance_bytes, [=](Uploads& uploads, const std::string& what, uint64_t n) {
            return fill_table(uploads, what, of_instance, n);
        });
    }
    void add(uint32_t number, uint64_t instance_bytes, Make make);
    // A buffer of at most `max_bytes`, whose size does not grow with the batch.
    void add_of_batch(uint32_t number, uint64_t max_bytes, Make make);
    // Keeps batches small enough for a buffer that they share and do not own, such as the arena of the staged update.
    // `instance_bytes`: what an instance takes of that buffer.
    void limit(uint64_t instance_bytes) { largest_bytes_ = std::max(largest_bytes_, instance_bytes); }
    // Host memory that a stage keeps for each instance.
    void add_host(uint64_t instance_bytes) { host_bytes_ += instance_bytes; }
    const Group& group() const { return group_; }
    const CrowdSettings& settings() const { return settings_; }
    // What an instance takes in all buffers together.
    uint64_t instance_bytes() const;
    uint64_t host_bytes() const { return host_bytes_; }    // what an instance takes on the host
    uint64_t batch_bytes() const { return batch_bytes_; }  // what a batch of any size takes in addition
    // The most that an instance takes in any one buffer, which decides how many instances form a batch.
    uint64_t largest_bytes() const { return largest_bytes_; }
    // Makes the buffers of a batch, for as many instances as it has.
    void make(Uploads& uploads, Batch& batch) const;

private:
    // Whether kernels write the buffer in the frame slot of their update; and whether it is copied there after the
    // kernels.
    bool is_only_in_slots(uint32_t number) const;
    bool is_copied_to_slots(uint32_t number) const;
    // How many buffers of this number a batch has.
    uint64_t buffer_count(uint32_t number) const;

    struct Entry {
        uint32_t number = 0;
        uint64_t instance_bytes = 0;
        Make make;
    };

    const Group& group_;
    const CrowdSettings& settings_;
    std::vector<Entry> entries_;
    uint64_t largest_bytes_ = 0, batch_bytes_ = 0, host_bytes_ = 0;
};

// For how many updates skin matrices are kept: the number of frame slots.
inline uint32_t frame_slot_count(const CrowdSettings& settings) {
    return settings.frames_in_flight + (settings.keep_previous_matrices ? 1 : 0);
}

// The memory that the poses of CrowdGroup::pose_capacity take.
uint64_t pose_bytes(const CrowdSettings& settings);

}  // namespace throng
