// Reads textures as the Vulkan renderer's samplers do: linearly, between mips too, or the nearest texel where texels
// are larger than pixels.
#pragma once

#include "raster/frame.h"
#include "raster/lane_vectors.h"

namespace throng::raster {
namespace {

// Of a positive number, within 2e-5: a least-squares polynomial, exact at powers of two.
INLINE Real log2(Real a) {
    const Whole bits = bits_of(a);
    const Real exponent = Real((bits >> 23) - 127), part = from_bits((bits & 0x7FFFFF) | 0x3F800000) - 1;
    Real p = -0.0445223644f;
    p = p * part + 0.147854708f;
    p = p * part - 0.267138851f;
    p = p * part + 0.441947126f;
    return exponent + part + part * (1 - part) * p;
}

// The fractional mip of a texture whose coordinates change by these steps from a pixel to its neighbours.
INLINE Real mip_of(const Texture& texture, vec2 step_x, vec2 step_y) {
    const vec2 size(static_cast<float>(texture.width), static_cast<float>(texture.height));
    const vec2 texels_x = step_x * size, texels_y = step_y * size;
    const Real longer = max(dot(texels_x, texels_x), dot(texels_y, texels_y));
    // At most 2^20 texels, so that the number is finite
    return clamp(0.5f * log2(clamp(longer, 1.0f, 0x1p40f)), 0.0f, static_cast<float>(texture.mip_count - 1));
}

// Texels on both sides of a coordinate.
struct Neighbours {
    Whole first, second;
    Real part;  // of the second
};
INLINE Neighbours neighbours(Real coordinate, Whole count, Wrap wrap) {
    if (wrap == Wrap::kRepeat) {
        const Real place = fract(coordinate) * Real(count) - 0.5f, whole = floor(place);
        const Whole first = truncated(whole);
        const Whole repeated = choose(first < 0, count - 1, first);  // also where the place is not a number
        return {repeated, choose(repeated + 1 == count, Whole(0), repeated + 1), place - whole};
    }
    Real within = coordinate;
    if (wrap == Wrap::kMirror) {  // there and back again
        const Real both = fract(coordinate * 0.5f) * 2;
        within = min(both, 2 - both);
    }
    const Real place = clamp(within, 0.0f, 1.0f) * Real(count) - 0.5f, whole = floor(place);
    const Whole first = truncated(whole), last = count - 1;
    return {min(max(first, Whole(0)), last), min(max(first + 1, Whole(0)), last), place - whole};
}

INLINE vec4 texel_of(const Texture& texture, Whole index) {
    const auto* const words = reinterpret_cast<const uint32_t*>(texture.texels);
    const Whole red_green = gather(words, index << 1), blue_alpha = gather(words + 1, index << 1);
    return {Real(red_green & 0xFFFF), Real((red_green >> 16) & 0xFFFF), Real(blue_alpha & 0xFFFF),
            Real((blue_alpha >> 16) & 0xFFFF)};
}

INLINE Whole size_of_mip(uint32_t size, Whole mip) {
    return max(Whole(Whole(static_cast<int32_t>(size)).v >> mip.v), Whole(1));
}

// Picks the nearer of two neighbours instead of mixing them.
INLINE Real rounded(Real part) { return choose(part < 0.5f, Real(0), Real(1)); }

// Mixes four texels of a mip; 0..65535. `is_magnified`: a texel is larger than a pixel.
INLINE vec4 bilinear(const Texture& texture, const Sampling& sampling, vec2 texcoord, Whole mip, Mask is_magnified) {
    const Whole width = size_of_mip(texture.width, mip);
    Neighbours column = neighbours(texcoord.x, width, sampling.wrap_u),
               row = neighbours(texcoord.y, size_of_mip(texture.height, mip), sampling.wrap_v);
    if (sampling.is_nearest) {
        column.part = choose(is_magnified, rounded(column.part), column.part);
        row.part = choose(is_magnified, rounded(row.part), row.part);
    }
    const Whole begin = gather(texture.mip_begins, mip), top = begin + row.first * width,
                bottom = begin + row.second * width;
    const auto across = [&](Whole of_row) {
        return mix(texel_of(texture, of_row + column.first), texel_of(texture, of_row + column.second), column.part);
    };
    return mix(across(top), across(bottom), row.part);
}

INLINE vec4 sampled(const Texture& texture, const Sampling& sampling, vec2 texcoord, Real mip) {
    const Real finer = floor(mip);
    const Mask is_magnified = mip <= 0.0f;
    vec4 texel = bilinear(texture, sampling, texcoord, truncated(finer), is_magnified);
    if (any(mip > finer)) {
        const Whole coarser = min(truncated(finer) + 1, Whole(static_cast<int32_t>(texture.mip_count) - 1));
        texel = mix(texel, bilinear(texture, sampling, texcoord, coarser, is_magnified), mip - finer);
    }
    return texel * (1 / 65535.0f);
}

}  // namespace
}  // namespace throng::raster
