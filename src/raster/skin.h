// Brings the vertices of a draw into world space, as character.vert does.
#pragma once

#include "raster/frame.h"
#include "raster/lane_types.h"
#include "raster/project.h"

namespace throng::raster {
namespace {

INLINE Four yzx(Four v) { return __builtin_shufflevector(v, v, 1, 2, 0, 3); }
// yzx() of this is the cross product.
INLINE Four cross_before_turn(Four a, Four b) { return a * yzx(b) - yzx(a) * b; }
INLINE float dot3(Four a, Four b) {
    const Four p = a * b;
    return p[0] + p[1] + p[2];
}

INLINE void transpose(Four& a, Four& b, Four& c, Four& d) {
    const Four ab0 = __builtin_shufflevector(a, b, 0, 4, 1, 5), ab1 = __builtin_shufflevector(a, b, 2, 6, 3, 7),
               cd0 = __builtin_shufflevector(c, d, 0, 4, 1, 5), cd1 = __builtin_shufflevector(c, d, 2, 6, 3, 7);
    a = __builtin_shufflevector(ab0, cd0, 0, 1, 4, 5);
    b = __builtin_shufflevector(ab0, cd0, 2, 3, 6, 7);
    c = __builtin_shufflevector(ab1, cd1, 0, 1, 4, 5);
    d = __builtin_shufflevector(ab1, cd1, 2, 3, 6, 7);
}

void place(const float* placement, const float* skin, uint32_t count, float* columns) {
    const Four moved[3]{{0, 0, 0, placement[3]}, {0, 0, 0, placement[7]}, {0, 0, 0, placement[11]}};
    for (uint32_t i = 0; i < count; ++i, skin += 12, columns += 16) {
        const Four r0 = load_any_four(skin), r1 = load_any_four(skin + 4), r2 = load_any_four(skin + 8);
        Four rows[4];
        for (uint32_t k = 0; k < 3; ++k)
            rows[k] = placement[4 * k] * r0 + placement[4 * k + 1] * r1 + placement[4 * k + 2] * r2 + moved[k];
        rows[3] = Four{};
        transpose(rows[0], rows[1], rows[2], rows[3]);
        for (uint32_t k = 0; k < 4; ++k) store_four(columns + 4 * k, rows[k]);
    }
}

// A weighted sum of matrices, and the vertex that it transforms.
#if defined(__AVX512F__)

struct Blended {
    __m512 columns;

    INLINE Blended(const float* from, const float* weights, const uint16_t* entries, uint32_t count) {
        columns = _mm512_mul_ps(_mm512_set1_ps(weights[0]), _mm512_load_ps(from + 16 * entries[0]));
        for (uint32_t i = 1; i < count; ++i)
            columns = _mm512_fmadd_ps(_mm512_set1_ps(weights[i]), _mm512_load_ps(from + 16 * entries[i]), columns);
    }
    // Four copies each of x, y, z, w.
    static INLINE __m512 spread(const float* p) {
        const __m512i of = _mm512_set_epi32(3, 3, 3, 3, 2, 2, 2, 2, 1, 1, 1, 1, 0, 0, 0, 0);
        return _mm512_permutexvar_ps(of, _mm512_castps128_ps512(_mm_load_ps(p)));
    }
    static INLINE Four sum(__m512 v) {
        const __m256 two = _mm256_add_ps(_mm512_castps512_ps256(v), _mm512_extractf32x8_ps(v, 1));
        return _mm_add_ps(_mm256_castps256_ps128(two), _mm256_extractf128_ps(two, 1));
    }
    INLINE Four point(const float* bind) const { return sum(_mm512_mul_ps(columns, spread(bind))); }
    // The normal, transformed by the cofactors of the matrix: the cross products 1 x 2, 2 x 0 and 0 x 1 of its columns,
    // beside each other. The fourth component is the determinant.
    INLINE Four normal_and_volume(const float* bind) const {
        const __m512 a = _mm512_shuffle_f32x4(columns, columns, _MM_SHUFFLE(3, 0, 2, 1)),
                     b = _mm512_shuffle_f32x4(columns, columns, _MM_SHUFFLE(3, 1, 0, 2));
        const __m512 a_turned = _mm512_permute_ps(a, _MM_SHUFFLE(3, 0, 2, 1)),
                     b_turned = _mm512_permute_ps(b, _MM_SHUFFLE(3, 0, 2, 1));
        const __m512 cofactors = _mm512_fmsub_ps(a, b_turned, _mm512_mul_ps(a_turned, b));
        Four normal = yzx(sum(_mm512_mul_ps(cofactors, spread(bind + 4))));
        normal[3] = dot3(Four(_mm512_castps512_ps128(columns)), yzx(Four(_mm512_castps512_ps128(cofactors))));
        return normal;
    }
};

#else

struct Blended {
    Four columns[4];

    INLINE Blended(const float* from, const float* weights, const uint16_t* entries, uint32_t count) {
        for (uint32_t k = 0; k < 4; ++k) columns[k] = weights[0] * load_four(from + 16 * entries[0] + 4 * k);
        for (uint32_t i = 1; i < count; ++i)
            for (uint32_t k = 0; k < 4; ++k) columns[k] += weights[i] * load_four(from + 16 * entries[i] + 4 * k);
    }
    INLINE Four point(const float* bind) const {
        return columns[0] * bind[0] + columns[1] * bind[1] + columns[2] * bind[2] + columns[3] * bind[3];
    }
    INLINE Four normal_and_volume(const float* bind) const {
        const Four x = cross_before_turn(columns[1], columns[2]), y = cross_before_turn(columns[2], columns[0]),
                   z = cross_before_turn(columns[0], columns[1]);
        Four normal = yzx(x * bind[4] + y * bind[5] + z * bind[6]);
        normal[3] = dot3(columns[0], yzx(x));
        return normal;
    }
};

#endif

// As pack_normal() of skin/normal.glsl, for any length except 0.
INLINE Whole packed_normal(Real x, Real y, Real z) {
    const Real scale = Real(32767) / max(abs(x) + abs(y) + abs(z), 1e-30f), one = 32767;
    const Real u = x * scale, v = y * scale;
    const Mask is_below = z < 0;
    const auto folded = [one](Real a, Real b) { return choose(a >= 0, one - abs(b), abs(b) - one); };
    const Whole low = truncated(round(choose(is_below, folded(u, v), u))),
                high = truncated(round(choose(is_below, folded(v, u), v)));
    return (low & 0xFFFF) | (high << 16);
}

struct WorldVertices {
    Real x, y, z, normal_x, normal_y, normal_z;
};

// Transposes as many vertices as there are lanes, each given as its place, 1, its normal and a sign: if that is
// negative, the normal is flipped.
INLINE WorldVertices turned(const float* vertices) {
    constexpr size_t kApart = 4 * 8;
    WorldVertices to;
    Real unused;
    const auto columns = [&](const float* from, Real& a, Real& b, Real& c, Real& d) {
        a = Real(Lanes::fours(from, kApart));
        b = Real(Lanes::fours(from + 8, kApart));
        c = Real(Lanes::fours(from + 16, kApart));
        d = Real(Lanes::fours(from + 24, kApart));
        Lanes::transpose(a.v, b.v, c.v, d.v);
    };
    columns(vertices, to.x, to.y, to.z, unused);
    Real volume;
    columns(vertices + 4, to.normal_x, to.normal_y, to.normal_z, volume);
    const Mask is_turned = volume < 0;
    to.normal_x = choose(is_turned, -to.normal_x, to.normal_x);
    to.normal_y = choose(is_turned, -to.normal_y, to.normal_y);
    to.normal_z = choose(is_turned, -to.normal_z, to.normal_z);
    return to;
}

// Where the vertices of a draw lie in the picture and in the map.
class Extent {
public:
    explicit Extent(const Frame& frame) : to_picture_(frame), to_map_(frame) {}

    INLINE void add(Real x, Real y, Real z) {
        const ScreenPoint seen = to_picture_.point(x, y, z), sunlit = to_map_.point(x, y, z);
        picture_.add(seen.x, seen.y);
        map_.add(sunlit.x, sunlit.y);
        nearest_ = max(seen.depth, nearest_);  // a depth that is NaN changes nothing
        farthest_ = min(seen.depth, farthest_);
    }
    void set(const Frame& frame, Draw& draw) const {
        picture_.set(frame.width, frame.height, draw.picture_box);
        if (lies_before_near()) draw.picture_box[2] = -1;
        map_.set(frame.map_size, frame.map_size, draw.map_box);
        draw.nearest = greatest(nearest_);
    }

private:
    // Whether all vertices lie nearer than the near plane, or behind the eye, so that nothing is visible.
    // ToPicture::point() gives such a vertex these three values.
    bool lies_before_near() const {
        return least(picture_.x0) >= kFarAway && least(picture_.y0) >= kFarAway && least(farthest_) >= 1;
    }

    struct Box {
        Real x0 = kFarAway, y0 = kFarAway, x1 = -kFarAway, y1 = -kFarAway;
        INLINE void add(Real x, Real y) {
            x0 = min(x0, x);
            y0 = min(y0, y);
            x1 = max(x1, x);
            y1 = max(y1, y);
        }
        // The box is the whole picture or map if the position of a vertex is not known.
        void set(uint32_t width, uint32_t height, float (&box)[4]) const {
            const bool is_known = greatest(x1) < kFarAway && greatest(y1) < kFarAway;
            box[0] = is_known ? least(x0) / kSubpixels : 0;
            box[1] = is_known ? least(y0) / kSubpixels : 0;
            box[2] = is_known ? greatest(x1) / kSubpixels : static_cast<float>(width);
            box[3] = is_known ? greatest(y1) / kSubpixels : static_cast<float>(height);
        }
    };
    ToPicture to_picture_;
    ToMap to_map_;
    Box picture_, map_;
    Real nearest_ = 0, farthest_ = 1;
};

// Calls set_vertex(i, to) for each vertex, which sets eight floats as turned() takes them. The last block is filled up
// with the last vertex.
template <class SetVertex>
INLINE void set_vertices(const Frame& frame, Draw& draw, const SetVertex& set_vertex) {
    const uint32_t count = draw.section->vertex_count;
    Extent extent(frame);
    alignas(64) float vertices[Lanes::kCount][8];
    for (uint32_t first = 0; first < count; first += kBlock) {
        float* const block = draw.vertices + first / kBlock * kBlockFloats;
        for (uint32_t part = 0; part < kBlock; part += Lanes::kCount) {
            for (uint32_t i = 0; i < Lanes::kCount; ++i) {
                const uint32_t vertex = first + part + i;
                set_vertex(vertex < count ? vertex : count - 1, vertices[i]);
            }
            const WorldVertices world = turned(vertices[0]);
            float* const fours = block + part / kFour * kFourFloats;
            store_fours(fours, kFourFloats, world.x);
            store_fours(fours + kFour, kFourFloats, world.y);
            store_fours(fours + 2 * kFour, kFourFloats, world.z);
            const Whole normals = packed_normal(world.normal_x, world.normal_y, world.normal_z);
            store_fours(fours + 3 * kFour, kFourFloats, from_bits(normals));
            extent.add(world.x, world.y, world.z);
        }
    }
    extent.set(frame, draw);
}

// Whether a vertex is mirrored depends on the blended matrix: rotations about different axes do not mirror, but may
// blend to a matrix that does.
void skin(const Frame& frame, const float* columns, const float* bind, Draw& draw) {
    const Section& section = *draw.section;
    if (!bind) bind = section.bind;
    const uint32_t influence_count = section.influence_count;
    set_vertices(frame, draw, [&](uint32_t i, float* to) INLINE_LAMBDA {
        const Blended matrix(columns, section.weights + size_t{i} * influence_count,
                             section.entries + size_t{i} * influence_count, influence_count);
        store_four(to, matrix.point(bind + size_t{i} * 8));
        store_four(to + 4, matrix.normal_and_volume(bind + size_t{i} * 8));
    });
}

void keep(const Frame& frame, const float* world, Draw& draw) {
    set_vertices(frame, draw, [&](uint32_t i, float* to) INLINE_LAMBDA {
        store_four(to, load_four(world + size_t{i} * 8));
        store_four(to + 4, load_four(world + size_t{i} * 8 + 4));
    });
}

}  // namespace
}  // namespace throng::raster
