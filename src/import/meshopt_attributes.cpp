#include "import/meshopt_attributes.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>

namespace throng::gltf {
namespace {

using Bytes = std::span<const uint8_t>;

// An element is divided into channels of four bytes. Elements are compressed in blocks: for each byte of the element
// there is a row of differences to the element before, one for each element of the block, in groups of 16.
constexpr size_t kChannelBytes = 4, kGroup = 16, kMaxBlock = 256, kMaxBlockBytes = 8192, kMinTailBytes = 24;

size_t max_block(size_t stride_bytes) { return std::min(kMaxBlockBytes / stride_bytes / kGroup * kGroup, kMaxBlock); }

// The tail is the element before the first one, and a byte for each channel that says how differences are applied.
size_t tail_bytes(size_t stride_bytes) { return stride_bytes + stride_bytes / kChannelBytes; }
size_t padded_tail_bytes(size_t stride_bytes) { return std::max(tail_bytes(stride_bytes), kMinTailBytes); }

template <class... Parts>
[[noreturn]] void fail_broken(const JsonView& json, const Parts&... message) {
    json.fail("the compressed data are broken: ", message...);
}

class Reader {
public:
    Reader(const JsonView& json, Bytes bytes) : json_(json), bytes_(bytes) {}

    Bytes take(size_t size_bytes) {
        if (size_bytes > bytes_.size()) fail_broken(json_, "they end too early");
        const Bytes taken = bytes_.first(size_bytes);
        bytes_ = bytes_.subspan(size_bytes);
        return taken;
    }
    size_t left() const { return bytes_.size(); }

private:
    const JsonView& json_;
    Bytes bytes_;
};

using Group = std::span<uint8_t, kGroup>;

// Differences of a few bits each. One whose bits are all set stands for a whole byte, which follows after the group.
template <unsigned kBits>
void read_packed(Reader& in, Group out) {
    constexpr unsigned kPerByte = 8 / kBits, kWholeByte = (1 << kBits) - 1;
    const Bytes packed = in.take(kGroup / kPerByte);
    for (unsigned i = 0; i < kGroup; ++i) {
        // Each byte is filled from its highest bit on, but single bits are from the lowest.
        const unsigned place = kBits == 1 ? i % kPerByte : kPerByte - 1 - i % kPerByte;
        const unsigned bits = packed[i / kPerByte] >> (kBits * place) & kWholeByte;
        out[i] = bits == kWholeByte ? in.take(1)[0] : static_cast<uint8_t>(bits);
    }
}

void read_group(Reader& in, unsigned bits, Group out) {
    switch (bits) {
        case 0: std::ranges::fill(out, uint8_t{0}); break;
        case 1: read_packed<1>(in, out); break;
        case 2: read_packed<2>(in, out); break;
        case 4: read_packed<4>(in, out); break;
        default: std::ranges::copy(in.take(kGroup), out.begin());
    }
}

using Row = std::array<uint8_t, kMaxBlock>;

// Each group has two bits that tell how many bits its differences have: one of `bits_of_header`. The last group is
// whole even if the block ends within it.
void read_groups(Reader& in, const std::array<unsigned, 4>& bits_of_header, size_t count, Row& out) {
    const size_t group_count = (count + kGroup - 1) / kGroup;
    const Bytes headers = in.take((group_count + 3) / 4);
    for (size_t g = 0; g < group_count; ++g) {
        const unsigned header = headers[g / 4] >> (g % 4 * 2) & 3;
        read_group(in, bits_of_header[header], std::span(out).subspan(g * kGroup).first<kGroup>());
    }
}

void read_row(Reader& in, unsigned control, size_t count, Row& out) {
    switch (control) {
        case 0: read_groups(in, {0, 1, 2, 4}, count, out); break;
        case 1: read_groups(in, {1, 2, 4, 8}, count, out); break;
        case 2: out.fill(0); break;
        default: std::ranges::copy(in.take(count), out.begin());
    }
}

// Adds differences to the bytes or the 16-bit words of a channel, with wraparound. They are stored as 0, -1, 1, -2, …
template <class Part>
uint32_t sum(uint32_t channel, uint32_t differences) {
    uint32_t out = 0;
    for (unsigned shift = 0; shift < 32; shift += 8 * sizeof(Part)) {
        const uint32_t stored = static_cast<Part>(differences >> shift);
        const uint32_t difference = stored >> 1 ^ (0 - (stored & 1));
        out |= uint32_t{static_cast<Part>((channel >> shift) + difference)} << shift;
    }
    return out;
}

using Rows = std::array<Row, kChannelBytes>;

// Writes one channel of a block. `out` begins with the channel in the first element; `value` is the channel in the
// element before; `next(value, differences)` is that in the element after.
template <class Next>
void write_channel(const Rows& rows, uint32_t value, std::span<std::byte> out, size_t stride_bytes, const Next& next) {
    for (size_t i = 0; i * stride_bytes < out.size(); ++i) {
        const std::array differences{rows[0][i], rows[1][i], rows[2][i], rows[3][i]};
        value = next(value, std::bit_cast<uint32_t>(differences));
        std::memcpy(out.data() + i * stride_bytes, &value, sizeof(value));
    }
}

// `mode` is the channel's byte of the tail. Its four high bits are a rotation for mode 2, and 0 for the others.
void write_channel(const JsonView& json, unsigned mode, const Rows& rows, uint32_t value, std::span<std::byte> out,
                   size_t stride_bytes) {
    if (mode == 0) return write_channel(rows, value, out, stride_bytes, sum<uint8_t>);
    if (mode == 1) return write_channel(rows, value, out, stride_bytes, sum<uint16_t>);
    if (mode % 16 != 2) fail_broken(json, "channel mode ", mode, " is unknown");
    const int rotation = static_cast<int>(mode / 16);
    write_channel(rows, value, out, stride_bytes, [rotation](uint32_t before, uint32_t difference) {
        return before ^ std::rotr(difference, rotation);
    });
}

// `before` is the element before the block.
void decode_block(const JsonView& json, Reader& in, Bytes modes, const std::byte* before, std::span<std::byte> out) {
    const size_t stride_bytes = modes.size() * kChannelBytes;
    const Bytes controls = in.take(modes.size());
    Rows rows;
    for (size_t c = 0; c < modes.size(); ++c) {
        for (unsigned b = 0; b < kChannelBytes; ++b)
            read_row(in, controls[c] >> (2 * b) & 3, out.size() / stride_bytes, rows[b]);
        uint32_t value = 0;
        std::memcpy(&value, before + c * kChannelBytes, sizeof(value));
        write_channel(json, modes[c], rows, value, out.subspan(c * kChannelBytes), stride_bytes);
    }
}

}  // namespace

uint64_t least_attributes_bytes(uint64_t count, uint64_t stride_bytes) {
    // A block without differences has two bits for each byte of the element.
    const uint64_t block = max_block(stride_bytes), block_count = (count + block - 1) / block;
    return 1 + block_count * (stride_bytes / kChannelBytes) + padded_tail_bytes(stride_bytes);
}

void decode_attributes(const JsonView& json, std::span<const std::byte> compressed, size_t stride_bytes,
                       std::span<std::byte> out, const Progress& progress) {
    const size_t padded = padded_tail_bytes(stride_bytes);
    if (compressed.size() < 1 + padded) fail_broken(json, "they end too early");
    const Bytes bytes(reinterpret_cast<const uint8_t*>(compressed.data()), compressed.size());
    const Bytes modes = bytes.last(stride_bytes / kChannelBytes);
    const std::byte* before = compressed.data() + compressed.size() - tail_bytes(stride_bytes);
    Reader in(json, bytes.first(bytes.size() - padded).subspan(1));

    const size_t block_bytes = max_block(stride_bytes) * stride_bytes;
    for (size_t at = 0; at < out.size(); at += block_bytes) {
        progress.poll();
        const auto block = out.subspan(at, std::min(block_bytes, out.size() - at));
        decode_block(json, in, modes, before, block);
        before = block.data() + block.size() - stride_bytes;
    }
    if (in.left() > 0) fail_broken(json, in.left(), " bytes are left over");
}

}  // namespace throng::gltf
