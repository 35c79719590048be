// Memory that a thread needs while it works on a part of a picture.
#pragma once

#include "native/aligned.h"

#include <array>
#include <memory>
#include <mutex>
#include <vector>

namespace throng {

// Grows as needed, and is kept.
class NativeScratch {
public:
    enum Use { kColumns, kMatrices, kBind, kWorld, kKernel, kUseCount };

    // Uninitialized memory at a multiple of 64 bytes, valid until the next call for the same use.
    std::byte* bytes(Use use, size_t size) {
        Part& part = parts_[use];
        if (part.size < size) {
            part.bytes = native::aligned_bytes(size);
            part.size = size;
        }
        return part.bytes.get();
    }
    template <class T>
    T* items(Use use, size_t count) {
        return reinterpret_cast<T*>(bytes(use, count * sizeof(T)));
    }

private:
    struct Part {
        native::AlignedBytes bytes;
        size_t size = 0;
    };
    std::array<Part, kUseCount> parts_;
};

// Keeps one NativeScratch for each thread that works at the same time.
class NativeScratchPool {
public:
    template <class Body>
    void with(const Body& body) {
        std::unique_ptr<NativeScratch> scratch = take();
        body(*scratch);
        const std::lock_guard lock(mutex_);
        free_.push_back(std::move(scratch));
    }

private:
    std::unique_ptr<NativeScratch> take() {
        const std::lock_guard lock(mutex_);
        if (free_.empty()) return std::make_unique<NativeScratch>();
        std::unique_ptr<NativeScratch> scratch = std::move(free_.back());
        free_.pop_back();
        return scratch;
    }

    std::mutex mutex_;
    std::vector<std::unique_ptr<NativeScratch>> free_;
};

}  // namespace throng
