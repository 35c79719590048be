// Poses of real characters against goldens that two other programs computed (shared/goldens/README.md).
#include "scan/scan_table.h"
#include "tests/test_device.h"

#include <throng/throng.h>

#include <nlohmann/json.hpp>

#include <fstream>

namespace throng {
namespace {

using nlohmann::json;
using namespace nlohmann::literals;

constexpr double kBound = 2e-5;  // of the character's size

struct Golden {
    std::filesystem::path file;
    Character character;
    json data;
    std::vector<Playback> playbacks;  // one per answer
    double size = 0;

    const json& answers() const { return data["answers"]; }
};

ClipPlayback slot_of(const json& request) {
    if (request["clip"].is_null()) return {};
    return {request["clip"].get<uint32_t>(), request["time"].get<double>(), 1, request["loop"].get<bool>()};
}

std::vector<Golden> load_goldens() {
    std::vector<Golden> goldens;
    for (const auto& folder : std::filesystem::directory_iterator(shared_folder("characters"))) {
        if (!folder.is_directory()) continue;
        for (const auto& file : std::filesystem::directory_iterator(folder)) {
            std::ifstream in(shared_folder("goldens") /
                             (folder.path().filename().string() + "__" + file.path().stem().string() + ".json"));
            if (!in) continue;
            Golden golden{.file = file.path()};
            golden.data = json::parse(in);
            Result<Character> character = load_character(file.path(), kExact);
            if (!character) {
                ADD_FAILURE() << character.error().text();
                continue;
            }
            golden.character = std::move(*character);
            golden.size = golden.character.size;
            for (const json& answer : golden.answers()) {
                const json& request = answer["request"];
                Playback playback{.first = slot_of(request)};
                if (request.contains("blend")) {
                    playback.second = slot_of(request["blend"]);
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

struct Computed {
    std::vector<AffineT<double>> model, skin;
    std::vector<Vec3<double>> positions;
};

// Largest errors of an answer as fractions of the size, and how many numbers were compared.
struct Comparison {
    double joint = 0, skin = 0, vertex = 0;
    uint64_t matrices = 0, vertices = 0;
};

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

void compare(const Golden& golden, const json& answer, const Computed& computed, Comparison& worst) {
    for (size_t s = 0; s < answer["skins"].size(); ++s) {
        const json& skin = answer["skins"][s];
        const Skin& ours = golden.character.skins[s];
        const json& declared = golden.data["skins"][s];
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
    for (size_t p = 0; p < golden.data["primitives"].size(); ++p) {
        const json& primitive = golden.data["primitives"][p];
        const auto section = std::find_if(
            golden.character.sections.begin(), golden.character.sections.end(), [&](const MeshSection& candidate) {
                return candidate.node == primitive["node"] && candidate.primitive == primitive["primitive"];
            });
        ASSERT_NE(section, golden.character.sections.end());
        EXPECT_EQ(section->vertex_count, primitive["vertexCount"].get<uint32_t>());
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

// Of the size. Where clips are compressed or matrices rounded only points are promised to stay near.
struct Bounds {
    double matrix = kBound, vertex = kBound;
};

void report(const Golden& golden, const std::string& method, const Comparison& worst, const Bounds& bounds = {}) {
    std::printf(
        "  %-22s %-16s %2zu answers, %5llu matrices, %5llu vertices; largest error of joints %.1e, skin %.1e, vertices "
        "%.1e\n",
        golden.character.name.c_str(), method.c_str(), golden.answers().size(),
        static_cast<unsigned long long>(worst.matrices), static_cast<unsigned long long>(worst.vertices), worst.joint,
        worst.skin, worst.vertex);
    EXPECT_LE(worst.joint, bounds.matrix) << golden.character.name << ", " << method;
    EXPECT_LE(worst.skin, bounds.matrix) << golden.character.name << ", " << method;
    EXPECT_LE(worst.vertex, bounds.vertex) << golden.character.name << ", " << method;
    EXPECT_GT(worst.matrices, 0u);
}

TEST(Golden, Reference) {
    THRONG_SKIP_WITHOUT(shared_folder("goldens"));
    size_t answer_count = 0;
    for (const Golden& golden : load_goldens()) {
        Comparison worst;
        for (size_t i = 0; i < golden.answers().size(); ++i) {
            const ReferencePose pose = *reference_pose(golden.character, golden.playbacks[i]);
            compare(golden, golden.answers()[i],
                    {pose.model_from_joint, pose.model_from_bind, reference_positions(golden.character, pose)}, worst);
        }
        report(golden, "reference", worst);
        answer_count += golden.answers().size();
    }
    std::printf("compared %zu answers\n", answer_count);
    EXPECT_GT(answer_count, 0u);
}

// All answers of a file are one crowd, so that the instances differ from each other.
void expect_golden(const Golden& golden, const Character& character, CrowdSettings settings, const std::string& label,
                   const Bounds& bounds) {
    const auto as_doubles = [](const auto& from, auto&& to) {
        for (const auto& value : from) to.push_back(value.template as<double>());
    };
    const auto count = static_cast<uint32_t>(golden.playbacks.size());
    settings.groups = {{&character, count}};
    settings.keep_model_matrices = true;
    Result<Crowd> crowd = Crowd::create(test_device(), settings);
    ASSERT_TRUE(crowd) << crowd.error().text();
    ASSERT_TRUE(crowd->set_playback(0, golden.playbacks));
    ASSERT_TRUE(crowd->update(0));
    Comparison worst;
    for (uint32_t i = 0; i < count; ++i) {
        Computed computed;
        as_doubles(*crowd->read_model_matrices(i), computed.model);
        as_doubles(*crowd->read_skin_matrices(i), computed.skin);
        as_doubles(*crowd->read_positions(i), computed.positions);
        compare(golden, golden.answers()[i], computed, worst);
    }
    report(golden, label, worst, bounds);
}

TEST(Golden, EveryScanMethodOnTheGpu) {
    THRONG_SKIP_WITHOUT(shared_folder("goldens"));
    for (const Golden& golden : load_goldens())
        for (const ScanMethodInfo& method : scan_methods()) {
            const bool takes_similarities = find_scan_method(method.name)->format == ScanFormat::kSimilarity;
            if (!method.in_crowds || (takes_similarities && !golden.character.rig.uniform_scale)) continue;
            expect_golden(golden, golden.character, {.path = UpdatePath::kStaged, .scan = method.name}, method.name,
                          {});
        }
}

TEST(Golden, InOnePassOnTheGpu) {
    THRONG_SKIP_WITHOUT(shared_folder("goldens"));
    constexpr double kAnyMatrix = 1;
    for (const Golden& golden : load_goldens()) {
        expect_golden(golden, golden.character, {.path = UpdatePath::kFused}, "fused", {});
        expect_golden(golden, golden.character, {.path = UpdatePath::kFused, .skin_format = SkinFormat::kHalfAffine},
                      "fused, 24 bytes", {.matrix = kAnyMatrix, .vertex = 5e-3});
        const Result<Character> packed = load_character(golden.file);
        ASSERT_TRUE(packed && packed->packed) << golden.file;
        const double bound = CompileSettings{}.error * packed->size / golden.size + kBound;
        for (const UpdatePath path : {UpdatePath::kFused, UpdatePath::kStaged})
            expect_golden(golden, *packed, {.path = path},
                          path == UpdatePath::kFused ? "fused, packed" : "staged, packed",
                          {.matrix = kAnyMatrix, .vertex = bound});
    }
}

}  // namespace
}  // namespace throng
