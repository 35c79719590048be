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
        Piece& piece = pieces_[use];
        if (piece.size < size) {
            piece.bytes = native::aligned_bytes(size);
            piece.size = size;
        }
        return piece.bytes.get();
    }
    template <class T>
    T* items(Use use, size_t count) {
        return reinterpret_cast<T*>(bytes(use, count * sizeof(T)));
    }

private:
    struct Piece {
        native::AlignedBytes bytes;
        size_t size = 0;
    };
    std::array<Piece, kUseCount> pieces_;
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
