#include "base/affine.h"
#include "import/readers.h"

#include <algorithm>
#include <cmath>

namespace throng::gltf {
namespace {

constexpr double kShearLimit = 1e-3;    // Decomposed::shear; exporters' rounding stays below 1e-5
constexpr double kNotUnitLimit = 1e-3;  // of a quaternion's length

// `m` is column-major, as in the file.
AffineT<double> affine_of(const std::array<double, 16>& m) {
    AffineT<double> affine;
    for (size_t r = 0; r < 3; ++r) affine.row[r] = {m[r], m[4 + r], m[8 + r], m[12 + r]};
    return affine;
}

Trs<double> read_transform(Reading& reading, const JsonView& json) {
    std::array<double, 16> matrix{};
    if (json.optional_numbers("matrix", matrix)) {
        if (json.has("translation") || json.has("rotation") || json.has("scale"))
            reading.warnings.add(json.place(),
                                 "has both a matrix and translation, rotation or scale: the matrix is used");
        const Decomposed out = decomposed(affine_of(matrix));
        if (out.shear > kShearLimit)
            reading.warnings.add(json.place_of("matrix"),
                                 "has shear, which translation, rotation and scale cannot give: it is dropped");
        return out.trs;
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

// Every node has one parent at most here, so a way up that does not end at a root is a cycle.
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
