#include "bind/skin_format.h"

#include "bind/bind_io.h"

#include <bit>
#include <cmath>
#include <cstring>

namespace throng {
namespace {

static_assert(io::kSkinAffine == static_cast<uint32_t>(SkinFormat::kAffine) &&
              io::kSkinHalfAffine == static_cast<uint32_t>(SkinFormat::kHalfAffine) &&
              io::kSkinSimilarity == static_cast<uint32_t>(SkinFormat::kSimilarity));

// IEEE 754 binary16.
float float_of_half(uint16_t half) {
    const uint32_t exponent = half >> 10 & 31, fraction = half & 1023;
    const float sign = half >> 15 ? -1.0f : 1.0f;
    if (exponent == 31) return fraction == 0 ? sign * INFINITY : NAN;
    if (exponent == 0) return sign * std::ldexp(static_cast<float>(fraction), -24);
    return sign * std::ldexp(static_cast<float>(1024 + fraction), static_cast<int>(exponent) - 25);
}

Affine affine_of_halves(const std::byte* bytes) {
    std::array<uint16_t, 12> halves;
    std::memcpy(halves.data(), bytes, sizeof halves);
    Affine m;
    for (size_t i = 0; i < halves.size(); ++i) m.row[i / 4][i % 4] = float_of_half(halves[i]);
    return m;
}

Affine affine_of_similarity(const std::byte* bytes) {
    std::array<float, 8> f;
    std::memcpy(f.data(), bytes, sizeof f);
    return to_affine(Trs<float>{
        .rotation = {f[0], f[1], f[2], f[3]}, .translation = {f[4], f[5], f[6]}, .scale = {f[7], f[7], f[7]}});
}

bool is_similarity(const Affine& m) {
    constexpr double kTolerance = 1e-5;
    const AffineT<double> d = m.as<double>();
    const auto row = [&](size_t r) { return Vec3<double>{d.row[r][0], d.row[r][1], d.row[r][2]}; };
    const double square = dot(row(0), row(0));
    const auto near = [&](double value, double wanted) { return std::abs(value - wanted) <= kTolerance * square; };
    return square > 0 && near(dot(row(1), row(1)), square) && near(dot(row(2), row(2)), square) &&
           near(dot(row(0), row(1)), 0) && near(dot(row(0), row(2)), 0) && near(dot(row(1), row(2)), 0);
}

// Why some skin matrix is not a similarity (rotation, translation and uniform scale); empty if all are.
// `which_is_all_that` completes the messages "…, which is all that …".
std::string similarity_unsupported_reason(const Character& character, const std::string& which_is_all_that) {
    if (!character.rig.uniform_scale)
        return "a joint is scaled differently along x, y and z; rotation, translation and uniform scale is all that " +
               which_is_all_that;
    for (size_t entry = 0; entry < character.palette.size(); ++entry)
        if (!is_similarity(character.palette[entry].joint_from_bind))
            return "the inverse bind matrix of palette entry " + std::to_string(entry) +
                   " is not made of rotation, translation and uniform scale, which is all that " + which_is_all_that;
    return {};
}

}  // namespace

uint32_t skin_format_bytes(SkinFormat format) {
    return format == SkinFormat::kAffine ? 48 : format == SkinFormat::kHalfAffine ? 24 : 32;
}

std::string skin_format_unsupported_reason(SkinFormat format, const Character& character) {
    return format == SkinFormat::kSimilarity
               ? similarity_unsupported_reason(character, "32-byte skin matrices can hold; use another format")
               : "";
}

std::string skin_blend_unsupported_reason(SkinBlend blend, const Character& character) {
    return blend == SkinBlend::kDualQuaternion
               ? similarity_unsupported_reason(character, "dual quaternions can blend; use the linear blend")
               : "";
}

std::vector<Affine> unpack_skin(SkinFormat format, std::span<const std::byte> bytes) {
    const size_t stride = skin_format_bytes(format);
    std::vector<Affine> out(bytes.size() / stride);
    for (size_t i = 0; i < out.size(); ++i) {
        const std::byte* at = bytes.data() + i * stride;
        if (format == SkinFormat::kAffine)
            std::memcpy(&out[i], at, sizeof(Affine));
        else
            out[i] = format == SkinFormat::kHalfAffine ? affine_of_halves(at) : affine_of_similarity(at);
    }
    return out;
}

}  // namespace throng
