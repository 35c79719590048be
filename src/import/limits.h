// The limits of the importer, and how much of them a read has used. A hostile file of a few kilobytes can claim
// gigabytes (accessors without data, many accessors over one buffer, compressed views), so whatever is decoded is
// charged here before it is allocated. Most charges are given back if the memory is freed while the file is still read.
#pragma once

#include "base/failure.h"
#include "base/progress.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

namespace throng::gltf {

inline constexpr uint64_t kFileLimitBytes = uint64_t(2) << 30;  // a file, and all side files of a file together
// The memory that a file's content may take at one time, parsed JSON and everything decoded: 384 MiB, or twelve times
// the size of the file and its side files, whichever is more. Twelve, because parsed JSON takes up to twelve times the
// size of its text.
inline constexpr uint64_t kMemoryLimitBytes = uint64_t(384) << 20, kMemoryOfFile = 12;
// What the meshes may take once compiled: as much as the content, but at least this much.
inline constexpr uint64_t kCompiledFloor_bytes = uint64_t(1) << 30;
// Everything that is decoded in the whole read, even if it is freed again, may be this many times the memory limit.
// Decoding takes time, and a file can refer to the same data again and again.
inline constexpr uint64_t kDecodedOfMemory = 16;
inline constexpr uint64_t kJsonLimitBytes = uint64_t(256) << 20;  // JSON text, data: URIs included
inline constexpr uint32_t kWarningLimit = 100;

// All work on a file's content is charged here, so this is also where cancellation is polled.
class Budget {
public:
    explicit Budget(uint64_t file_bytes, const Progress& progress = {}) : progress_(progress.between(0, 0)) {
        add_file(file_bytes);
    }

    void add_file(uint64_t size_bytes) {
        file_bytes_ += size_bytes;
        limit_bytes_ = std::max(kMemoryLimitBytes, kMemoryOfFile * file_bytes_);
    }
    // Fails with kLimit where `size_bytes` more would exceed a limit.
    void charge(uint64_t size_bytes, const std::string& place) {
        progress_.poll();
        if (size_bytes > limit_bytes_ - used_bytes_)
            throw Failure(ErrorCode::kLimit, place, "the file's content needs more than the limit of ",
                          limit_bytes_ >> 20, " MiB of memory (384, or ", kMemoryOfFile,
                          " times the size of the file)");
        const uint64_t decoded_limit_bytes = kDecodedOfMemory * limit_bytes_;
        if (size_bytes > decoded_limit_bytes - decoded_bytes_)
            throw Failure(ErrorCode::kLimit, place, "reading the file would decode more than the limit of ",
                          decoded_limit_bytes >> 20, " MiB (", kDecodedOfMemory,
                          " times the memory that its content may take): it refers to the same data too often");
        used_bytes_ += size_bytes;
        decoded_bytes_ += size_bytes;
    }
    // Charges `count` elements of `element_bytes` each.
    void charge(uint64_t count, uint64_t element_bytes, const std::string& place) {
        const bool too_large = element_bytes > 0 && count > limit_bytes_ / element_bytes;
        charge(too_large ? limit_bytes_ + 1 : count * element_bytes, place);
    }
    // The compiled meshes have a limit of their own: nodes that show the same mesh again and again cost a file next to
    // nothing, and honest files do so a thousand times.
    void require_room_for_compiled(uint64_t size_bytes) const {
        const uint64_t limit_bytes = std::max(kCompiledFloor_bytes, limit_bytes_);
        if (size_bytes > limit_bytes)
            throw Failure(ErrorCode::kLimit, "meshes", "they take ", size_bytes >> 20,
                          " MiB once compiled, each counted for every node that shows it; the limit is ",
                          limit_bytes >> 20, " MiB (", kCompiledFloor_bytes >> 20, ", or ", kMemoryOfFile,
                          " times the size of the file): show fewer of them, or simpler ones");
    }

    // Polls; to be called at each step of a loop over decoded data.
    void poll_at(uint64_t step) const { progress_.poll_at(step); }
    // Only for polling: progress that is reported to it does not count.
    const Progress& progress() const { return progress_; }

private:
    friend class TemporaryCharge;

    Progress progress_;
    uint64_t file_bytes_ = 0, limit_bytes_ = 0, used_bytes_ = 0, decoded_bytes_ = 0;
};

// A charge for memory that is needed for a while only. The destructor gives it back.
class TemporaryCharge {
public:
    explicit TemporaryCharge(Budget& budget) : budget_(budget) {}
    ~TemporaryCharge() { budget_.used_bytes_ -= size_bytes_; }
    TemporaryCharge(const TemporaryCharge&) = delete;
    TemporaryCharge& operator=(const TemporaryCharge&) = delete;

    // As Budget::charge().
    void add(uint64_t count, uint64_t element_bytes, const std::string& place) {
        budget_.charge(count, element_bytes, place);
        size_bytes_ += count * element_bytes;
    }

private:
    Budget& budget_;
    uint64_t size_bytes_ = 0;
};

// Zeros for `count` elements of `element_bytes` each. They are charged until the last copy of the pointer is gone.
inline std::shared_ptr<std::vector<std::byte>> charged_bytes(Budget& budget, uint64_t count, uint64_t element_bytes,
                                                             const std::string& place) {
    struct Charged {
        explicit Charged(Budget& charged_to) : charge(charged_to) {}
        TemporaryCharge charge;
        std::vector<std::byte> bytes;
    };
    const auto charged = std::make_shared<Charged>(budget);
    charged->charge.add(count, element_bytes, place);
    charged->bytes.resize(count * element_bytes);
    return {charged, &charged->bytes};
}

}  // namespace throng::gltf
