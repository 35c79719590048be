// What KHR_meshopt_compression adds: version 1 of the codec of attributes, and the filter of colours. The files in
// tests/data/meshopt come from meshoptimizer's own encoder (make.mjs there).
#include "import/meshopt.h"
#include "tests/files.h"
#include "tests/host/import_cases.h"

#include <algorithm>
#include <array>
#include <limits>

namespace throng::test {
namespace {

using Bytes = std::vector<std::byte>;

Bytes data_file(const std::string& name) {
    const std::string content = read_file(std::filesystem::path(THRONG_SOURCE_DIR) / "tests/data/meshopt" / name);
    EXPECT_FALSE(content.empty()) << name;
    const auto bytes = std::as_bytes(std::span(content));
    return {bytes.begin(), bytes.end()};
}

struct Attributes {
    size_t count, stride_bytes;
    int level;  // of the encoder

    std::string name() const {
        return "attributes_" + std::to_string(count) + "x" + std::to_string(stride_bytes) + "_level" +
               std::to_string(level) + ".bin";
    }
};
// More than a block of 256 elements or 8 KiB, or less; all that the codec can do is used by one of them.
constexpr Attributes kAttributes[]{{1, 4, 2},    {257, 8, 1},  {33, 12, 2}, {300, 16, 0},
                                   {300, 16, 3}, {531, 32, 3}, {70, 256, 3}};

// The 32 bits of channel `c` in element `i`, as in make.mjs.
uint32_t word(uint32_t i, uint32_t c) {
    const uint32_t noise = (((i * 64 + c + 1) * 0x9E3779B1u ^ 0x7F4A7C15u) * 0x85EBCA6Bu) >> 8;
    switch (c % 8) {
        case 0: return i * i * 3 + (((i * 40503) & 0xFFFF) << 16);
        case 1: return (i >> 5) | (i & 1) << 8 | (noise & 3) << 16 | (noise & 12) << 22;
        case 2: return 0x3F800000 + ((noise & 7) << 9);
        case 3: return 0x01020304;
        case 4: return noise << 8;
        case 5: return (noise & 15) | (i % 50 == 7 ? 0xAB0000 : 0) | (i % 16 > 12 ? noise & 0xFF00 : 0);
        case 6: return (i % 9) | (noise & 31) << 8 | ((i * 5) & 255) << 16;
        default: return 0x40000000 ^ (i << 13) ^ (noise & 1);
    }
}

Bytes elements(const Attributes& a) {
    Bytes out;
    for (uint32_t i = 0; i < a.count; ++i)
        for (uint32_t c = 0; c < a.stride_bytes / 4; ++c) {
            const std::array value{word(i, c)};
            const auto bytes = std::as_bytes(std::span(value));
            out.insert(out.end(), bytes.begin(), bytes.end());
        }
    return out;
}

Bytes decoded(const Bytes& compressed, uint64_t count, uint64_t stride_bytes, const char* filter = "NONE") {
    const GltfJson extension = {
        {"mode", "ATTRIBUTES"}, {"filter", filter}, {"count", count}, {"byteStride", stride_bytes}};
    const JsonText json(extension.dump(), JsonAuthor::kProgram);
    gltf::Budget budget(compressed.size());
    return *gltf::decode_meshopt(json.view(), compressed, budget);
}

// The message of the refusal; empty if there is none.
std::string refusal(const Bytes& compressed, uint64_t count, uint64_t stride_bytes, const char* filter = "NONE") {
    try {
        EXPECT_EQ(decoded(compressed, count, stride_bytes, filter).size(), count * stride_bytes);
        return {};
    } catch (const Failure& failure) {
        return failure.error.message;
    }
}

void expect_refusal(const std::string& part, const Bytes& compressed, uint64_t count, uint64_t stride_bytes,
                    const char* filter = "NONE") {
    const std::string message = refusal(compressed, count, stride_bytes, filter);
    EXPECT_NE(message.find(part), message.npos) << "'" << message << "', but wanted: " << part;
}

// A stream without differences: all elements are as the one of the tail, whose bytes are 7.
Bytes constant_elements(size_t count, size_t stride_bytes) {
    const size_t block = std::min<size_t>(8192 / stride_bytes / 16 * 16, 256), channel_count = stride_bytes / 4,
                 controls = (count + block - 1) / block * channel_count,
                 padding = 24 - std::min<size_t>(stride_bytes + channel_count, 24);
    Bytes out(1 + controls + padding + stride_bytes + channel_count);
    out[0] = std::byte{0xA1};
    std::fill_n(out.begin() + 1, controls, std::byte{0b10101010});
    std::fill_n(out.end() - std::ptrdiff_t(stride_bytes + channel_count), stride_bytes, std::byte{7});
    return out;
}

TEST(ImportMeshopt1, Attributes) {
    for (const Attributes& a : kAttributes)
        EXPECT_TRUE(decoded(data_file(a.name()), a.count, a.stride_bytes) == elements(a)) << a.name();
}

// The component `c` of color `i`, 0..1, as in make.mjs.
double color_component(size_t i, size_t c) {
    const size_t of_255[]{i, i * 7, 255 - i, i * 3};
    return double(of_255[c] % 256) / 255;
}

template <class T>
void expect_colors(int bits) {
    const size_t count = 100, stride_bytes = 4 * sizeof(T);
    const std::string name = "colors_" + std::to_string(stride_bytes) + "_" + std::to_string(bits) + "bit";
    const Bytes bytes = decoded(data_file(name + ".bin"), count, stride_bytes, "COLOR");
    EXPECT_TRUE(bytes == data_file(name + "_decoded.bin")) << name << ": meshoptimizer's decoder differs";
    std::vector<T> components(count * 4);
    std::memcpy(components.data(), bytes.data(), bytes.size());
    for (size_t i = 0; i < components.size(); ++i)
        EXPECT_NEAR(double(components[i]) / std::numeric_limits<T>::max(), color_component(i / 4, i % 4),
                    2.0 / ((1 << bits) - 1))
            << name << ", component " << i;
}

TEST(ImportMeshopt1, Colors) {
    for (const int bits : {8, 5, 2}) expect_colors<uint8_t>(bits);
    for (const int bits : {16, 12}) expect_colors<uint16_t>(bits);
}

TEST(ImportMeshopt1, ColorsThatNoEncoderWrites) {
    // Y, Co, Cg and alpha are 7: three bits, of which alpha's highest one only says so.
    const Bytes sevens = decoded(constant_elements(1, 4), 1, 4, "COLOR");
    EXPECT_EQ(sevens.at(0), std::byte{255}) << "7 + 7 - 7 of 7";
    EXPECT_EQ(sevens.at(1), std::byte{255}) << "7 + 7, clamped";
    EXPECT_EQ(sevens.at(2), std::byte{0}) << "7 - 7 - 7, clamped";
    EXPECT_EQ(sevens.at(3), std::byte{255}) << "3 of 3";
    for (const int alpha : {0, 1}) {
        Bytes none = constant_elements(300, 4);
        none.at(none.size() - 2) = std::byte(alpha);
        expect_refusal("element 0 has no color: its alpha is " + std::to_string(alpha), none, 300, 4, "COLOR");
    }
    expect_refusal("byteStride 12 is not allowed with filter COLOR", constant_elements(1, 12), 1, 12, "COLOR");
}

TEST(ImportMeshopt1, WhatIsShorterIsRefused) {
    for (const Attributes& a : {Attributes{33, 12, 2}, {300, 16, 3}}) {
        const Bytes whole = data_file(a.name());
        for (size_t size = 0; size < whole.size(); ++size)
            EXPECT_NE(refusal({whole.begin(), whole.begin() + std::ptrdiff_t(size)}, a.count, a.stride_bytes), "")
                << size << " bytes of " << a.name();
    }
}

// Mostly for the sanitizers: nothing is read or written out of bounds.
TEST(ImportMeshopt1, BrokenBytesAreRefusedOrDecoded) {
    int refused = 0, decoded = 0;
    for (const Attributes& a : {Attributes{1, 4, 2}, {33, 12, 2}, {300, 16, 3}}) {
        const Bytes whole = data_file(a.name());
        for (size_t at = 0; at < whole.size(); ++at)
            for (const int flipped : {0x01, 0x02, 0x0C, 0x10, 0xE0, 0xFF}) {
                Bytes broken = whole;
                broken[at] ^= std::byte(flipped);
                ++(refusal(broken, a.count, a.stride_bytes).empty() ? decoded : refused);
            }
    }
    EXPECT_GT(refused, 0);
    EXPECT_GT(decoded, 0);
}

TEST(ImportMeshopt1, Refusals) {
    const Bytes whole = data_file("attributes_33x12_level2.bin");
    Bytes broken = whole;
    broken[0] = std::byte{0xA2};
    expect_refusal("meshoptimizer error", broken, 33, 12);
    broken = whole;
    broken.insert(broken.begin() + std::ptrdiff_t(whole.size() - 24), 2, std::byte{0});
    expect_refusal("2 bytes are left over", broken, 33, 12);
    expect_refusal("they end too early", whole, 49, 12);
    for (const int mode : {3, 0x0F, 0x10, 0x11, 0x13}) {
        broken = whole;
        broken.back() = std::byte(mode);
        expect_refusal("channel mode " + std::to_string(mode) + " is unknown", broken, 33, 12);
    }
}

TEST(ImportMeshopt1, FewBytesMayBeManyElementsUpToTheLimits) {
    for (const size_t stride_bytes : std::array<size_t, 4>{4, 12, 32, 256})
        for (const size_t count : std::array<size_t, 6>{1, 32, 33, 256, 257, 10'000}) {
            const Bytes least = constant_elements(count, stride_bytes);
            EXPECT_EQ(decoded(least, count, stride_bytes), Bytes(count * stride_bytes, std::byte{7}));
            expect_refusal("too few", {least.begin(), least.end() - 1}, count, stride_bytes);
        }
    expect_refusal("too few", constant_elements(1, 4), 1ull << 52, 256);
    const size_t count = gltf::kMemoryLimitBytes / 4 + 1;
    expect_refusal("limit of 384 MiB", constant_elements(count, 4), count, 4);
}

}  // namespace
}  // namespace throng::test
