// Lanes are characters: matrices -> memory.
#pragma once

#include "bind/bind_io.h"
#include "native/kernel_decode.h"
#include "native/kernel_similarity.h"

namespace {

inline constexpr uint32_t kLine = 16;  // words of a cache line, which is written as a whole
inline constexpr uint32_t kBatch = 3 * kLine;
inline constexpr uint32_t kRing = 4 * kLine;  // a batch, and the words of the next one that are already there

// Skin matrices on their way to memory: [word of the ring][character].
struct alignas(64) Ring {
    float of[kRing][Lanes::kCount];
};

// Where skin matrices go. Those of all characters begin at the same offset in a cache line, so that each line is
// complete for all characters at the same time.
struct SkinTarget {
    std::byte* line[Lanes::kCount];  // the one in which the character's first matrix begins
    uint32_t begin;                  // words from there to the matrix
    uint32_t written, position;      // words: end of the written batches, place of the next matrix
    uint32_t count;                  // of characters
};

inline constexpr uint32_t kOfLine = kLine / Lanes::kCount;  // vectors of a cache line

// Transposes a line of four characters, from c on: [vector of the line][character].
INLINE void transpose_line(const Ring& ring, uint32_t word, uint32_t c, V (&r)[kOfLine][4]) {
    const float* in = ring.of[word % kRing];
    for (uint32_t v = 0; v < kOfLine; ++v) {
        for (uint32_t k = 0; k < 4; ++k)
            r[v][k] = Lanes::fours(in + (v * Lanes::kCount + k) * Lanes::kCount + c, 4 * Lanes::kCount);
        Lanes::transpose(r[v][0], r[v][1], r[v][2], r[v][3]);
    }
}

// Writes parts of lines: at both ends of a character's matrices, and everywhere if there are fewer characters than
// lanes. Words come at least in pairs.
[[gnu::noinline]] void flush_part(const Ring& ring, const SkinTarget& target, uint32_t from, uint32_t to) {
    for (uint32_t line = from / kLine * kLine; line < to; line += kLine) {
        alignas(64) float transposed[Lanes::kCount][kLine];
        for (uint32_t c = 0; c < Lanes::kCount; c += 4) {
            V r[kOfLine][4];
            transpose_line(ring, line, c, r);
            for (uint32_t k = 0; k < 4; ++k)
                for (uint32_t v = 0; v < kOfLine; ++v) Lanes::store(transposed[c + k] + v * Lanes::kCount, r[v][k]);
        }
        const uint32_t begin = from > line ? from - line : 0, end = to - line < kLine ? to - line : kLine;
        for (uint32_t c = 0; c < target.count; ++c)
            for (uint32_t word = begin; word < end; word += 2)
                __builtin_memcpy(target.line[c] + size_t{4} * (line + word), transposed[c] + word, 8);
    }
}

// Writes whole lines by streaming stores.
INLINE void flush_lines(const Ring& ring, const SkinTarget& target, uint32_t from, uint32_t to) {
    for (uint32_t c = 0; c < Lanes::kCount; c += 4)
        for (uint32_t line = from; line < to; line += kLine) {
            V r[kOfLine][4];
            transpose_line(ring, line, c, r);
            for (uint32_t k = 0; k < 4; ++k) {
                auto* at = reinterpret_cast<float*>(target.line[c + k] + size_t{4} * line);
                for (uint32_t v = 0; v < kOfLine; ++v) Lanes::stream(at + v * Lanes::kCount, r[v][k]);
            }
        }
}

INLINE void flush_batch(const Ring& ring, SkinTarget& target) {
    const uint32_t from = target.written, to = from + kBatch;
    target.written = to;
    if (target.count < Lanes::kCount) return flush_part(ring, target, from == 0 ? target.begin : from, to);
    if (from > 0 || target.begin == 0) return flush_lines(ring, target, from, to);
    flush_part(ring, target, target.begin, kLine);
    flush_lines(ring, target, kLine, to);
}

// Groups of kUnit words do not wrap around the end of the ring, since matrices begin at multiples of kUnit.
template <uint32_t kWords, uint32_t kUnit>
INLINE void put_words(Ring& ring, SkinTarget& target, const V* words) {
    for (uint32_t i = 0; i < kWords; i += kUnit)
        for (uint32_t k = 0; k < kUnit; ++k) Lanes::store(ring.of[(target.position + i) % kRing + k], words[i + k]);
    target.position += kWords;
    if (target.position - target.written >= kBatch) flush_batch(ring, target);
}

INLINE void put_affine(Ring& ring, SkinTarget& target, const Matrix& m) {
    V words[12];
    for (uint32_t i = 0; i < 12; ++i) words[i] = m.of[i / 4][i % 4];
    put_words<12, 4>(ring, target, words);
}

INLINE void finish(const Ring& ring, const SkinTarget& target) {
    uint32_t from = target.written == 0 ? target.begin : target.written;
    const uint32_t end = target.position / kLine * kLine;
    if (target.count == Lanes::kCount && from % kLine == 0 && from < end) {
        flush_lines(ring, target, from, end);
        from = end;
    }
    if (from < target.position) flush_part(ring, target, from, target.position);
}

// Sets the words of a skin matrix as it lies in memory (bind/skin_format.glsl). Returns how many there are.
INLINE uint32_t skin_words(uint32_t format, const Matrix& m, V (&words)[12]) {
    if (format == io::kSkinHalfAffine) {
        for (uint32_t i = 0; i < 6; ++i) words[i] = Lanes::halves(m.of[i / 2][i % 2 * 2], m.of[i / 2][i % 2 * 2 + 1]);
        return 6;
    }
    if (format == io::kSkinSimilarity) {
        similarity_words(m, words);
        return 8;
    }
    for (uint32_t i = 0; i < 12; ++i) words[i] = m.of[i / 4][i % 4];
    return 12;
}

// Writes the words of each character to place_of(c).
template <class PlaceOf>
INLINE void scatter(const V* words, uint32_t count, uint32_t character_count, const PlaceOf& place_of) {
    alignas(64) float at[12][Lanes::kCount];
    for (uint32_t i = 0; i < count; ++i) Lanes::store(at[i], words[i]);
    for (uint32_t c = 0; c < character_count; ++c) {
        float* to = place_of(c);
        for (uint32_t i = 0; i < count; ++i) to[i] = at[i][c];
    }
}

struct Outputs {
    Ring ring;
    SkinTarget target;
};

// Writes any matrix. The common one, a skin matrix of 48 bytes in palette order that needs no constant, goes to
// put_affine() instead.
[[gnu::noinline]] void emit(const KernelRig& rig, const KernelUpdate& update, const Emission& emission,
                            const float* source, const Played* all, Outputs& out) {
    Matrix m = load_matrix(source);
    if (emission.constant != kNoIndex) m = product(m, splat(rig.constants + size_t{emission.constant} * 12));
    V words[12];
    if (emission.kind == EmissionKind::kModel || emission.kind == EmissionKind::kSocket) {
        const bool is_model = emission.kind == EmissionKind::kModel;
        for (uint32_t i = 0; i < 12; ++i) words[i] = m.of[i / 4][i % 4];
        float* const array = is_model ? update.model : update.sockets;
        const size_t stride = is_model ? rig.rig_joint_count : rig.socket_count;
        scatter(words, 12, out.target.count,
                [=](uint32_t c) { return array + 12 * (all[c].instance * stride + emission.target); });
        return;
    }
    const uint32_t count = skin_words(update.skin_format, m, words);
    if (emission.kind == EmissionKind::kSkinAt)
        scatter(words, count, out.target.count, [&](uint32_t c) {
            return reinterpret_cast<float*>(out.target.line[c]) + out.target.begin + size_t{emission.target} * count;
        });
    else if (count == 12)
        put_words<12, 4>(out.ring, out.target, words);
    else if (count == 8)
        put_words<8, 4>(out.ring, out.target, words);
    else
        put_words<6, 2>(out.ring, out.target, words);
}

}  // namespace
