#include "import/readers.h"

#include <algorithm>
#include <cmath>

namespace throng::gltf {
namespace {

constexpr double kShearLimit = 1e-3;    // cosine between two axes of a matrix; exporters' rounding stays below 1e-5
constexpr double kNotUnitLimit = 1e-3;  // of a quaternion's length

// From a rotation matrix given by its columns.
// Source: S. W. Shepperd, "Quaternion from Rotation Matrix", Journal of Guidance and Control 1(3), 1978.
Quaternion<double> quaternion_from_axes(const Vec3<double>& x, const Vec3<double>& y, const Vec3<double>& z) {
    const double trace = x.x + y.y + z.z;
    Quaternion<double> q;
    if (trace >= x.x && trace >= y.y && trace >= z.z) {
        q = {y.z - z.y, z.x - x.z, x.y - y.x, 1 + trace};
    } else if (x.x >= y.y && x.x >= z.z) {
        q = {1 + x.x - y.y - z.z, x.y + y.x, z.x + x.z, y.z - z.y};
    } else if (y.y >= z.z) {
        q = {x.y + y.x, 1 - x.x + y.y - z.z, y.z + z.y, z.x - x.z};
    } else {
        q = {z.x + x.z, y.z + z.y, 1 - x.x - y.y + z.z, x.y - y.x};
    }
    return normalized(q);
}

// Axes of zero length are replaced so that the three stay orthogonal: their scale is zero, but the rotation is not
// lost.
void complete_axes(std::array<Vec3<double>, 3>& axes, const std::array<double, 3>& lengths) {
    const auto missing = std::count(lengths.begin(), lengths.end(), 0.0);
    if (missing == 3) axes = {{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
    if (missing == 2) {
        const size_t kept = size_t(std::find_if(lengths.begin(), lengths.end(), [](double l) { return l != 0; }) -
                                   lengths.begin());
        const Vec3<double>& axis = axes[kept];
        const Vec3<double> other = std::abs(axis.x) < 0.5 ? Vec3<double>{1, 0, 0} : Vec3<double>{0, 1, 0};
        axes[(kept + 1) % 3] = normalized(cross(axis, other));
        axes[(kept + 2) % 3] = cross(axis, axes[(kept + 1) % 3]);
    }
    if (missing == 1) {
        const size_t lost = size_t(std::find(lengths.begin(), lengths.end(), 0.0) - lengths.begin());
        axes[lost] = normalized(cross(axes[(lost + 1) % 3], axes[(lost + 2) % 3]));
    }
}

// `m` is column-major, as in the file. Where the matrix mirrors, the scale of x is negated, as three.js does.
Trs<double> decomposed(const std::array<double, 16>& m, bool& has_shear) {
    std::array<Vec3<double>, 3> axes{{{m[0], m[1], m[2]}, {m[4], m[5], m[6]}, {m[8], m[9], m[10]}}};
    std::array<double, 3> lengths{};
    for (size_t i = 0; i < 3; ++i) {
        lengths[i] = length(axes[i]);
        axes[i] = normalized(axes[i]);
    }
    complete_axes(axes, lengths);
    has_shear = false;
    for (size_t i = 0; i < 3; ++i) has_shear = has_shear || std::abs(dot(axes[i], axes[(i + 1) % 3])) > kShearLimit;
    if (dot(cross(axes[0], axes[1]), axes[2]) < 0) {
        axes[0] = axes[0] * -1.0;
        lengths[0] = -lengths[0];
    }
    return {
        quaternion_from_axes(axes[0], axes[1], axes[2]), {m[12], m[13], m[14]}, {lengths[0], lengths[1], lengths[2]}};
}

Trs<double> read_transform(Reading& reading, const JsonView& json) {
    std::array<double, 16> matrix{};
    if (json.optional_numbers("matrix", matrix)) {
        if (json.has("translation") || json.has("rotation") || json.has("scale"))
            reading.warnings.add(json.place(),
                                 "has both a matrix and translation, rotation or scale: the matrix is used");
        bool has_shear = false;
        const Trs<double> out = decomposed(matrix, has_shear);
        if (has_shear)
            reading.warnings.add(json.place_of("matrix"),
                                 "has shear, which translation, rotation and scale cannot give: it is dropped");
        return out;
    }
    std::array<double, 3> translation{0, 0, 0}, scale{1, 1, 1};
    std::array<double, 4> rotation{0, 0, 0, 1};
    json.optional_numbers("translation", translation);
    json.optional_numbers("scale", scale);
    json.optional_numbers("rotation", rotation);
    const Quaternion<double> q{rotation[0], rotation[1], rotation[2], rotation[3]};
    if (std::abs(std::sqrt(dot(q, q)) - 1) > kNotUnitLimit)
        reading.warnings.add(json.place_of("rotation"), "is not of unit length: it is normalised");
    return {normalized(q), {translation[0], translation[1], translation[2]}, {scale[0], scale[1], scale[2]}};
}

// Every node has one parent at most by now, so whatever does not end at a root goes round.
void refuse_cycles(const JsonView& nodes, const std::vector<AssetNode>& list) {
    std::vector<uint8_t> seen(list.size(), 0);  // 1: on the present way up; 2: known to end at a root
    std::vector<uint32_t> way;
    for (uint32_t start = 0; start < list.size(); ++start) {
        way.clear();
        for (uint32_t node = start; node != kNone && seen[node] != 2; node = list[node].parent) {
            if (seen[node] == 1) nodes[node].fail("is its own ancestor");
            seen[node] = 1;
            way.push_back(node);
        }
        for (const uint32_t node : way) seen[node] = 2;
    }
}

}  // namespace

void read_nodes(Reading& reading, Asset& asset) {
    const JsonView nodes = reading.charged_array("nodes", sizeof(AssetNode));
    asset.nodes.resize(nodes.size());
    for (uint32_t i = 0; i < nodes.size(); ++i) {
        const JsonView json = nodes[i];
        asset.nodes[i].name = read_name(reading, json);
        asset.nodes[i].parent_from_node = read_transform(reading, json);
        for (const JsonView child : json.optional_array("children")) {
            uint32_t& parent = asset.nodes[child.as_index(nodes.size(), "nodes")].parent;
            if (parent != kNone) child.fail("is a child of nodes[", parent, "] already");
            parent = i;
        }
    }
    refuse_cycles(nodes, asset.nodes);
}

}  // namespace throng::gltf
