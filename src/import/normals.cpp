#include "import/normals.h"

namespace throng {

std::vector<Vec3<float>> smooth_normals(const AssetPrimitive& primitive) {
    std::vector<Vec3<float>> normals(primitive.positions.size());
    for (size_t i = 0; i + 2 < primitive.indices.size(); i += 3) {
        const auto corner = [&](size_t k) { return primitive.positions[primitive.indices[i + k]]; };
        const Vec3<float> area = cross(corner(1) - corner(0), corner(2) - corner(0));
        for (size_t k = 0; k < 3; ++k) normals[primitive.indices[i + k]] = normals[primitive.indices[i + k]] + area;
    }
    for (auto& normal : normals) normal = normalized(normal);
    return normals;
}

}  // namespace throng
