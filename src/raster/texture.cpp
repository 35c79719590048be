#include "raster/texture.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>

namespace throng::raster {
namespace {

constexpr uint32_t kChannels = 4;

std::array<uint64_t, 256> levels_of(TexelKind kind) {
    std::array<uint64_t, 256> levels{};
    for (uint32_t i = 0; i < levels.size(); ++i) {
        const double part = i / 255.0;
        const double linear = kind == TexelKind::kNumbers ? part
                              : part <= 0.04045           ? part / 12.92
                                                          : std::pow((part + 0.055) / 1.055, 2.4);
        levels[i] = static_cast<uint64_t>(std::lround(linear * 65535));
    }
    return levels;
}

// Which two texels of a row or column a texel of the next smaller mip lies between.
struct Between {
    uint32_t first, second;
    float part;  // of the second
};

std::vector<Between> all_between(uint32_t from, uint32_t to) {
    std::vector<Between> all(to);
    for (uint32_t i = 0; i < to; ++i) {
        const float place = (static_cast<float>(i) + 0.5f) * static_cast<float>(from) / static_cast<float>(to) - 0.5f;
        const auto first = static_cast<uint32_t>(std::max(place, 0.0f));
        all[i] = {first, std::min(first + 1, from - 1), place - static_cast<float>(first)};
    }
    return all;
}

uint64_t mixed(const uint64_t* above, const uint64_t* below, const Between& x, float y_part) {
    uint64_t texel = 0;
    for (uint32_t channel = 0; channel < kChannels; ++channel) {
        const uint32_t shift = 16 * channel;
        const auto across = [&](const uint64_t* row) {
            const auto first = static_cast<float>(row[x.first] >> shift & 0xFFFF),
                       second = static_cast<float>(row[x.second] >> shift & 0xFFFF);
            return first + x.part * (second - first);
        };
        const float top = across(above);
        texel |= static_cast<uint64_t>(top + y_part * (across(below) - top) + 0.5f) << shift;
    }
    return texel;
}

}  // namespace

OwnedTexture::OwnedTexture(const Picture& picture, TexelKind kind) {
    texture_.width = picture.width;
    texture_.height = picture.height;
    texture_.mip_count = static_cast<uint32_t>(std::bit_width(std::max(picture.width, picture.height)));
    const auto width = [&](uint32_t mip) { return std::max(picture.width >> mip, 1u); };
    const auto height = [&](uint32_t mip) { return std::max(picture.height >> mip, 1u); };
    uint32_t count = 0;
    for (uint32_t mip = 0; mip < texture_.mip_count; ++mip) {
        texture_.mip_begins[mip] = count;
        count += width(mip) * height(mip);
    }
    texels_.resize(count);
    texture_.texels = texels_.data();

    const std::array<uint64_t, 256> colors = levels_of(kind), numbers = levels_of(TexelKind::kNumbers);
    for (size_t i = 0; i < size_t{picture.width} * picture.height; ++i) {
        const uint8_t* const rgba = &picture.rgba[i * kChannels];
        texels_[i] = colors[rgba[0]] | colors[rgba[1]] << 16 | colors[rgba[2]] << 32 | numbers[rgba[3]] << 48;
    }
    for (uint32_t mip = 1; mip < texture_.mip_count; ++mip) {
        const std::vector<Between> columns = all_between(width(mip - 1), width(mip)),
                                   rows = all_between(height(mip - 1), height(mip));
        const uint64_t* const from = &texels_[texture_.mip_begins[mip - 1]];
        uint64_t* to = &texels_[texture_.mip_begins[mip]];
        for (const Between& row : rows)
            for (const Between& column : columns)
                *to++ = mixed(from + size_t{row.first} * width(mip - 1), from + size_t{row.second} * width(mip - 1),
                              column, row.part);
    }
}

}  // namespace throng::raster
