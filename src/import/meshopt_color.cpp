#include "import/meshopt_color.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <cstring>
#include <limits>
#include <type_traits>

namespace throng::gltf {
namespace {

// A component of `bits` bits, scaled to all bits of `T` and rounded. Encoders keep it in its range; outside of it, it
// is clamped.
template <class T>
T scaled(int component, int bits) {
    const int64_t one = (1 << bits) - 1, value = std::clamp<int64_t>(component, 0, one);
    return static_cast<T>((2 * value * std::numeric_limits<T>::max() + one) / (2 * one));
}

template <class T>
void to_rgba(const JsonView& json, std::span<std::byte> elements) {
    std::array<T, 4> color;
    for (size_t at = 0; at < elements.size(); at += sizeof(color)) {
        std::memcpy(&color, elements.data() + at, sizeof(color));
        // The number of bits is told by the highest one of alpha, which is set and does not belong to its value.
        const int bits = std::bit_width(color[3]);
        if (bits < 2) json.fail("element ", at / sizeof(color), " has no color: its alpha is ", color[3]);
        const int y = color[0];
        const int co = static_cast<std::make_signed_t<T>>(color[1]), cg = static_cast<std::make_signed_t<T>>(color[2]);
        // So alpha has a bit less than the others; its last one is repeated.
        const int alpha = color[3] - (1 << (bits - 1));
        color = {scaled<T>(y + co - cg, bits), scaled<T>(y + cg, bits), scaled<T>(y - co - cg, bits),
                 scaled<T>(2 * alpha + alpha % 2, bits)};
        std::memcpy(elements.data() + at, &color, sizeof(color));
    }
}

}  // namespace

void decode_colors(const JsonView& json, std::span<std::byte> elements, size_t stride_bytes) {
    stride_bytes == 4 ? to_rgba<uint8_t>(json, elements) : to_rgba<uint16_t>(json, elements);
}

}  // namespace throng::gltf
