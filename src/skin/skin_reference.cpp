#include "skin/skin_reference.h"

#include <algorithm>
#include <cmath>

namespace throng {
namespace {

AffineT<double> weighted_sum(std::span<const WeightedTransform> transforms) {
    AffineT<double> sum{};
    for (auto& row : sum.row) row = {};
    for (const auto& [weight, transform] : transforms)
        for (size_t r = 0; r < 3; ++r)
            for (size_t c = 0; c < 4; ++c) sum.row[r][c] += weight * transform.row[r][c];
    return sum;
}

// The quaternion of a rotation matrix: four times the product of two components each, in the row of the largest one.
Quaternion<double> rotation_of(const std::array<std::array<double, 4>, 3>& m) {
    const std::array squares{1 + m[0][0] - m[1][1] - m[2][2], 1 + m[1][1] - m[0][0] - m[2][2],
                             1 + m[2][2] - m[0][0] - m[1][1], 1 + m[0][0] + m[1][1] + m[2][2]};
    const double xy = m[0][1] + m[1][0], xz = m[0][2] + m[2][0], yz = m[1][2] + m[2][1], xw = m[2][1] - m[1][2],
                 yw = m[0][2] - m[2][0], zw = m[1][0] - m[0][1];
    switch (std::ranges::max_element(squares) - squares.begin()) {
        case 0: return normalized(Quaternion<double>{squares[0], xy, xz, xw});
        case 1: return normalized(Quaternion<double>{xy, squares[1], yz, yw});
        case 2: return normalized(Quaternion<double>{xz, yz, squares[2], zw});
        default: return normalized(Quaternion<double>{xw, yw, zw, squares[3]});
    }
}

// A rotation, a uniform scale, which mirrors where it is negative, and a translation.
Trs<double> parts_of(AffineT<double> m) {
    const double scale = std::cbrt(determinant(m));
    const Vec3<double> translation{m.row[0][3], m.row[1][3], m.row[2][3]};
    for (auto& row : m.row)
        for (double& x : row) x /= scale;
    return {rotation_of(m.row), translation, {scale, scale, scale}};
}

Quaternion<double> operator+(const Quaternion<double>& a, const Quaternion<double>& b) {
    return {a.x + b.x, a.y + b.y, a.z + b.z, a.w + b.w};
}
Quaternion<double> operator*(const Quaternion<double>& q, double factor) {
    return {q.x * factor, q.y * factor, q.z * factor, q.w * factor};
}

AffineT<double> dual_quaternion_sum(std::span<const WeightedTransform> transforms) {
    Quaternion<double> rotation{0, 0, 0, 0}, dual{0, 0, 0, 0};
    double scale = 0;
    for (const auto& [weight, transform] : transforms) {
        const Trs<double> parts = parts_of(transform);
        const double side = dot(rotation, parts.rotation) < 0 ? -weight : weight;
        const Quaternion<double> translation{parts.translation.x, parts.translation.y, parts.translation.z, 0};
        rotation = rotation + parts.rotation * side;
        dual = dual + translation * parts.rotation * (side / 2);
        scale += weight * parts.scale.x;
    }
    const double size = std::sqrt(dot(rotation, rotation));
    const Quaternion<double> unit = rotation * (1 / size), back{-unit.x, -unit.y, -unit.z, unit.w};
    const Quaternion<double> translation = dual * (2 / size) * back;
    return to_affine(Trs<double>{unit, {translation.x, translation.y, translation.z}, {scale, scale, scale}});
}

}  // namespace

AffineT<double> blended_transform(SkinBlend blend, std::span<const WeightedTransform> transforms) {
    return blend == SkinBlend::kLinear ? weighted_sum(transforms) : dual_quaternion_sum(transforms);
}

std::vector<Vec3<double>> skin_reference(const Character& character, std::span<const AffineT<double>> model_from_bind,
                                         std::span<const WeightedMorph> morphs, SkinBlend blend) {
    std::vector<Vec3<double>> positions(character.vertices.size());
    std::vector<WeightedTransform> transforms;
    for (const MeshSection& section : character.sections) {
        for (uint32_t vertex = 0; vertex < section.vertex_count; ++vertex) {
            transforms.clear();
            for (uint32_t set = 0; set < section.influence_sets; ++set) {
                const Influences& influences =
                    character.influences[section.first_influences + vertex * section.influence_sets + set];
                for (size_t i = 0; i < 4; ++i)
                    if (influences.weights[i] != 0)
                        transforms.push_back({double{influences.weights[i]}, model_from_bind[influences.entries[i]]});
            }
            positions[section.first_vertex + vertex] = transform_point(
                blended_transform(blend, transforms), morphed_position_reference(character, section, vertex, morphs));
        }
    }
    return positions;
}

}  // namespace throng
