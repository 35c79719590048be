#include "skin/skin_reference.h"

#include <algorithm>
#include <cmath>

namespace throng {
namespace {

// The quaternion of a rotation matrix. Computes four times its largest component times each of the four, and
// normalizes.
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

// Splits a matrix into rotation, translation and uniform scale; a negative scale mirrors.
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

}  // namespace

void BlendedTransform::add(double weight, const AffineT<double>& transform) {
    if (blend_ == SkinBlend::kDualQuaternion) return add_dual_quaternion(weight, parts_of(transform));
    for (size_t r = 0; r < 3; ++r)
        for (size_t c = 0; c < 4; ++c) sum_.row[r][c] += weight * transform.row[r][c];
}

void BlendedTransform::add_dual_quaternion(double weight, const Trs<double>& parts) {
    const double side = dot(rotation_, parts.rotation) < 0 ? -weight : weight;
    const Quaternion<double> translation{parts.translation.x, parts.translation.y, parts.translation.z, 0};
    rotation_ = rotation_ + parts.rotation * side;
    dual_ = dual_ + translation * parts.rotation * (side / 2);
    scale_ += weight * parts.scale.x;
}

AffineT<double> BlendedTransform::result() const {
    if (blend_ == SkinBlend::kLinear) return sum_;
    const double size = std::sqrt(dot(rotation_, rotation_));
    const Quaternion<double> unit = rotation_ * (1 / size), back{-unit.x, -unit.y, -unit.z, unit.w};
    const Quaternion<double> translation = dual_ * (2 / size) * back;
    return to_affine(Trs<double>{unit, {translation.x, translation.y, translation.z}, {scale_, scale_, scale_}});
}

AffineT<double> blended_reference(const Character& character, const MeshSection& section, uint32_t vertex_index,
                                  std::span<const AffineT<double>> model_from_bind, SkinBlend blend) {
    BlendedTransform transform(blend);
    for (uint32_t set = 0; set < section.influence_sets; ++set) {
        const Influences& influences =
            character.influences[section.first_influences + vertex_index * section.influence_sets + set];
        for (size_t i = 0; i < 4; ++i)
            if (influences.weights[i] != 0)
                transform.add(double{influences.weights[i]}, model_from_bind[influences.entries[i]]);
    }
    return transform.result();
}

std::vector<Vec3<double>> skin_reference(const Character& character, std::span<const AffineT<double>> model_from_bind,
                                         std::span<const WeightedMorph> morphs, SkinBlend blend) {
    std::vector<Vec3<double>> positions(character.vertices.size());
    for (const MeshSection& section : character.sections) {
        for (uint32_t vertex = 0; vertex < section.vertex_count; ++vertex)
            positions[section.first_vertex + vertex] = transform_point(
                blended_reference(character, section, vertex, model_from_bind, blend),
                morphed_position_reference(character, section, vertex, morphs));
    }
    return positions;
}

}  // namespace throng
