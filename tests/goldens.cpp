#include "tests/goldens.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <limits>

namespace throng::test {
namespace {

using nlohmann::json;
using namespace nlohmann::literals;

ClipPlayback clip_playback_of(const json& request) {
    if (request["clip"].is_null()) return {};
    return {request["clip"].get<uint32_t>(), request["time"].get<double>(), 1, request["loop"].get<bool>()};
}

// A matrix's linear part is compared relative to its largest element, its translation relative to the size.
double matrix_error(const AffineT<double>& m, const json& golden, double size) {
    double scale = 1, linear = 0, translation = 0;
    for (size_t column = 0; column < 4; ++column)
        for (size_t row = 0; row < 3; ++row) {
            const double wanted = golden[column * 4 + row].get<double>(),
                         difference = std::abs(m.row[row][column] - wanted);
            if (!(difference >= 0)) return std::numeric_limits<double>::infinity();
            if (column < 3) {
                scale = std::max(scale, std::abs(wanted));
                linear = std::max(linear, difference);
            } else {
                translation = std::max(translation, difference);
            }
        }
    return std::max(linear / scale, translation / size);
}

}  // namespace

std::vector<Golden> load_goldens() {
    std::vector<Golden> goldens;
    for (const auto& folder : std::filesystem::directory_iterator(shared_folder("characters"))) {
        if (!folder.is_directory()) continue;
        for (const auto& file : std::filesystem::directory_iterator(folder)) {
            std::ifstream in(shared_folder("goldens") /
                             (folder.path().filename().string() + "__" + file.path().stem().string() + ".json"));
            if (!in) continue;
            Golden golden{.file = file.path()};
            golden.data = std::make_shared<json>(json::parse(in));
            Result<Character> character = load_character(file.path(), {.error = 0, .lods = false});
            if (!character) {
                ADD_FAILURE() << character.error().text();
                continue;
            }
            golden.character = std::move(*character);
            golden.size = golden.character.size;
            for (const json& answer : (*golden.data)["answers"]) {
                const json& request = answer["request"];
                Playback playback{.first = clip_playback_of(request)};
                if (request.contains("blend")) {
                    playback.second = clip_playback_of(request["blend"]);
                    playback.weight = request["blend"]["weight"].get<float>();
                }
                golden.playbacks.push_back(playback);
                golden.size = std::min(golden.size, answer.value("/threeMaxDiff/size"_json_pointer, golden.size));
            }
            goldens.push_back(std::move(golden));
        }
    }
    return goldens;
}

void compare(const Golden& golden, size_t number, const Computed& computed, Comparison& worst) {
    const json& data = *golden.data;
    const json& answer = data["answers"][number];
    for (size_t s = 0; s < answer["skins"].size(); ++s) {
        const json& skin = answer["skins"][s];
        const Skin& ours = golden.character.skins[s];
        const json& declared = data["skins"][s];
        const json& world = declared.contains("jointWorldAsSkin")
                                ? answer["skins"][declared["jointWorldAsSkin"].get<size_t>()]["jointWorld"]
                                : skin["jointWorld"];
        ASSERT_EQ(declared["jointNodes"].size(), ours.joint_count);
        for (uint32_t k = 0; k < ours.joint_count; ++k) {
            const uint32_t entry = ours.first_entry + k, joint = golden.character.palette[entry].joint;
            ASSERT_EQ(golden.character.rig.nodes[joint], declared["jointNodes"][k].get<uint32_t>());
            worst.joint = std::max(worst.joint, matrix_error(computed.model[joint], world[k], golden.size));
            worst.skin = std::max(worst.skin, matrix_error(computed.skin[entry], skin["skinMatrix"][k], golden.size));
            worst.matrices += 2;
        }
    }
    for (size_t p = 0; p < data["primitives"].size(); ++p) {
        const json& primitive = data["primitives"][p];
        const auto section = std::find_if(
            golden.character.sections.begin(), golden.character.sections.end(), [&](const MeshSection& candidate) {
                return candidate.node == primitive["node"] && candidate.primitive == primitive["primitive"];
            });
        ASSERT_NE(section, golden.character.sections.end());
        ASSERT_EQ(section->own_vertex_count(), primitive["vertexCount"].get<uint32_t>());
        for (size_t v = 0; v < primitive["vertices"].size(); ++v) {
            const json& wanted = answer["primitives"][p]["positions"][v];
            const Vec3<double>& position =
                computed.positions[section->first_vertex + primitive["vertices"][v].get<uint32_t>()];
            const double error = length(position - Vec3<double>{wanted[0], wanted[1], wanted[2]}) / golden.size;
            worst.vertex = error >= 0 ? std::max(worst.vertex, error) : std::numeric_limits<double>::infinity();
            ++worst.vertices;
        }
    }
}

void report(const Golden& golden, const std::string& method, const Comparison& worst, const GoldenBounds& bounds) {
    std::printf(
        "  %-22s %-16s %2zu answers, %5llu matrices, %5llu vertices; largest error of joints %.1e, skin %.1e, vertices "
        "%.1e\n",
        golden.character.name.c_str(), method.c_str(), golden.playbacks.size(),
        static_cast<unsigned long long>(worst.matrices), static_cast<unsigned long long>(worst.vertices), worst.joint,
        worst.skin, worst.vertex);
    EXPECT_LE(worst.joint, bounds.matrix) << golden.character.name << ", " << method;
    EXPECT_LE(worst.skin, bounds.matrix) << golden.character.name << ", " << method;
    EXPECT_LE(worst.vertex, bounds.vertex) << golden.character.name << ", " << method;
    EXPECT_GT(worst.matrices, 0u);
}

}  // namespace throng::test
