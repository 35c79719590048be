#include "base/crc64.h"

#include <lzma.h>

namespace throng {

uint64_t crc64(std::span<const std::byte> bytes, uint64_t before) {
    return lzma_crc64(reinterpret_cast<const uint8_t*>(bytes.data()), bytes.size(), before);
}

}  // namespace throng
