// The limits of the importer, and how much of them a read has used. A hostile file of a few kilobytes can claim
// gigabytes (accessors without data, many accessors over one buffer, compressed views), so whatever is decoded is
// charged here before it is allocated.
#pragma once

#include "base/failure.h"
#include "base/progress.h"

#include <algorithm>
#include <cstdint>
#include <string>

namespace throng::gltf {

inline constexpr uint64_t kFileLimitBytes = uint64_t(2) << 30;  // a file, and all side files of a file together
// The memory that a file's content may take, JSON as read and everything decoded: 384 MiB, or twelve times the size of
// the file and its side files, whichever is more. Twelve, because JSON takes up to that many times its text.
inline constexpr uint64_t kMemoryLimitBytes = uint64_t(384) << 20, kMemoryOfFile = 12;
inline constexpr uint64_t kJsonLimitBytes = uint64_t(256) << 20;  // JSON text, data: URIs included
inline constexpr uint32_t kWarningLimit = 100;

// All work on a file's content is charged here, so this is also where it polls whether it should go on.
class Budget {
public:
    explicit Budget(uint64_t file_bytes, const Progress& progress = {}) : progress_(progress.between(0, 0)) {
        add_file(file_bytes);
    }

    void add_file(uint64_t size_bytes) {
        file_bytes_ += size_bytes;
        limit_bytes_ = std::max(kMemoryLimitBytes, kMemoryOfFile * file_bytes_);
    }
    // Fails with kLimit where `size_bytes` more would exceed the limit.
    void charge(uint64_t size_bytes, const std::string& place) {
        progress_.poll();
        if (size_bytes > limit_bytes_ - used_bytes_)
            throw Failure(ErrorCode::kLimit, place, "the file's content needs more than the limit of ",
                          limit_bytes_ >> 20, " MiB of memory (384, or ", kMemoryOfFile,
                          " times the size of the file)");
        used_bytes_ += size_bytes;
    }
    // Charges `count` elements of `element_bytes` each; count is at most 2^53.
    void charge(uint64_t count, uint64_t element_bytes, const std::string& place) {
        charge(count > limit_bytes_ ? limit_bytes_ + 1 : count * element_bytes, place);
    }

    // Polls; to be called at each step of a loop over decoded data.
    void poll_at(uint64_t step) const { progress_.poll_at(step); }
    // Only for polling: progress that is reported to it does not count.
    const Progress& progress() const { return progress_; }

private:
    Progress progress_;
    uint64_t file_bytes_ = 0, limit_bytes_ = 0, used_bytes_ = 0;
};

}  // namespace throng::gltf
