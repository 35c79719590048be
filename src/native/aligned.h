// Memory that is aligned to cache lines.
#pragma once

#include <cstddef>
#include <memory>
#include <new>

namespace throng::native {

inline constexpr std::align_val_t kLineAlignment{64};

struct DeleteAligned {
    void operator()(std::byte* bytes) const { ::operator delete[](bytes, kLineAlignment); }
};
using AlignedBytes = std::unique_ptr<std::byte[], DeleteAligned>;

inline AlignedBytes aligned_bytes(size_t size) { return AlignedBytes(new (kLineAlignment) std::byte[size]); }

}  // namespace throng::native
