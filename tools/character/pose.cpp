#include "tools/cli/command.h"
#include "tools/cli/kept_characters.h"
#include "tools/commands.h"

#include <nlohmann/json.hpp>

#include <cstdio>
#include <optional>

namespace throng::tools {
namespace {

struct PoseOptions {
    std::string file, clip, blend, scan = "auto", vertices = "0", device;
    double time_s = 0, blend_time_s = 0, weight = 0.5;
    bool loop = false, reference = false, json = false;
    CompileSettings compile{.error = 0, .lods = false};
};

// The result of either computation: the GPU's floats or the reference's doubles.
struct Pose {
    std::string device;
    std::vector<AffineT<double>> model_from_joint, model_from_bind;
    std::vector<Vec3<double>> positions;
};

Playback playback_of(const PoseOptions& options, const Character& character) {
    Playback playback;
    if (!options.clip.empty()) playback.first = {find_clip(character, options.clip), options.time_s, 1, options.loop};
    if (!options.blend.empty()) {
        playback.second = {find_clip(character, options.blend), options.blend_time_s, 1, options.loop};
        playback.weight = static_cast<float>(options.weight);
    }
    return playback;
}

Pose pose_by_reference(const Character& character, const Playback& playback, bool with_positions) {
    ReferencePose pose = unwrap(reference_pose(character, playback));
    std::vector<Vec3<double>> positions;
    if (with_positions) positions = reference_positions(character, pose);
    return {"reference", std::move(pose.model_from_joint), std::move(pose.model_from_bind), std::move(positions)};
}

Pose pose_on_device(const Character& character, const Playback& playback, const PoseOptions& options,
                    bool with_positions) {
    const Device device = open_device(options.device);
    Crowd crowd = unwrap(
        Crowd::create(device, {.groups = {{&character, 1}}, .scan = options.scan, .keep_model_matrices = true}));
    unwrap(crowd.set_playback(InstanceHandle{0}, playback));
    unwrap(crowd.update(0));
    Pose pose{device.info().name, {}, {}, {}};
    for (const Affine& m : unwrap(crowd.read_model_matrices({0}))) pose.model_from_joint.push_back(m.as<double>());
    for (const Affine& m : unwrap(crowd.read_skin_matrices({0}))) pose.model_from_bind.push_back(m.as<double>());
    if (with_positions)
        for (const Vec3<float>& p : unwrap(crowd.read_positions({0}))) pose.positions.push_back(p.as<double>());
    return pose;
}

nlohmann::json column_major(const AffineT<double>& m) {
    nlohmann::json out = nlohmann::json::array();
    for (size_t column = 0; column < 4; ++column) {
        for (size_t row = 0; row < 3; ++row) out.push_back(m.row[row][column]);
        out.push_back(column == 3 ? 1 : 0);
    }
    return out;
}

nlohmann::json to_json(const Character& character, const Pose& pose, std::optional<uint32_t> vertex_limit) {
    nlohmann::json skins = nlohmann::json::array(), primitives = nlohmann::json::array();
    for (size_t s = 0; s < character.skins.size(); ++s) {
        nlohmann::json names = nlohmann::json::array(), world = nlohmann::json::array(), skin = nlohmann::json::array();
        for (uint32_t k = 0; k < character.skins[s].joint_count; ++k) {
            const uint32_t entry = character.skins[s].first_entry + k, joint = character.palette[entry].joint;
            names.push_back(character.rig.names[joint]);
            world.push_back(column_major(pose.model_from_joint[joint]));
            skin.push_back(column_major(pose.model_from_bind[entry]));
        }
        skins.push_back({{"skin", s}, {"joints", names}, {"jointWorld", world}, {"skinMatrix", skin}});
    }
    nlohmann::json joints = nlohmann::json::array(), joint_world = nlohmann::json::array();
    for (uint32_t joint = 0; joint < character.rig.joint_count(); ++joint) {
        joints.push_back(character.rig.names[joint]);
        joint_world.push_back(column_major(pose.model_from_joint[joint]));
    }
    for (const MeshSection& section : character.sections) {
        // If not all vertices are asked for, takes some that are spread evenly over the primitive.
        const uint32_t count = std::min(vertex_limit.value_or(section.own_vertex_count()), section.own_vertex_count());
        nlohmann::json indices = nlohmann::json::array(), positions = nlohmann::json::array();
        for (uint32_t i = 0; i < count; ++i) {
            const auto vertex = static_cast<uint32_t>(uint64_t{i} * section.own_vertex_count() / count);
            const Vec3<double>& p = pose.positions[section.first_vertex + vertex];
            indices.push_back(vertex);
            positions.push_back({p.x, p.y, p.z});
        }
        primitives.push_back({{"node", section.node},
                              {"mesh", section.mesh},
                              {"primitive", section.primitive},
                              {"skin", section.skin == kNone ? nlohmann::json() : nlohmann::json(section.skin)},
                              {"vertices", indices},
                              {"positions", positions}});
    }
    return {{"file", character.name},
            {"device", pose.device},
            {"rig", {{"joints", joints}, {"jointWorld", joint_world}}},
            {"skins", skins},
            {"primitives", primitives}};
}

void print_text(const Character& character, const Pose& pose) {
    std::printf("%s on %s: joint, parent, position in model space\n", character.name.c_str(), pose.device.c_str());
    for (uint32_t joint = 0; joint < character.rig.joint_count(); ++joint) {
        const auto& row = pose.model_from_joint[joint].row;
        const uint32_t parent = character.rig.parents[joint];
        std::printf("%5u %5s  % .6f % .6f % .6f  %s\n", joint, parent == kNone ? "-" : std::to_string(parent).c_str(),
                    row[0][3], row[1][3], row[2][3], character.rig.names[joint].c_str());
    }
}

// "all" means no limit.
std::optional<uint32_t> parse_vertices(const std::string& text) {
    if (text == "all") return std::nullopt;
    if (const auto limit = parse_number(text)) return limit;
    throw UsageError("--vertices " + text + ": give a number or 'all'");
}

void run_pose(const PoseOptions& options) {
    const std::optional<uint32_t> vertex_limit = parse_vertices(options.vertices);
    const Character character = unwrap(load_kept_character(options.file, options.compile));
    print_warnings(character.warnings);
    const Playback playback = playback_of(options, character);
    const bool with_positions = vertex_limit != 0u;
    const Pose pose = options.reference ? pose_by_reference(character, playback, with_positions)
                                        : pose_on_device(character, playback, options, with_positions);
    if (options.json)
        print_json(to_json(character, pose, vertex_limit));
    else
        print_text(character, pose);
}

}  // namespace

void add_pose(Command app) {
    Command command = app.add_subcommand(
        "pose", "joint matrices, skin matrices and skinned vertices of one character at one time");
    PoseOptions& options = command.options_of(run_pose);
    command.add_option("file", options.file, "a glTF 2.0 file, or one that 'throng compile' wrote").required();
    Option clip = command.add_option("--clip", options.clip, "name or number of a clip (default: the rest pose)");
    command.add_option("--time", options.time_s, "seconds into the clip")
        .needs(clip)
        .check(finite())
        .capture_default_str();
    command.add_flag("--loop", options.loop, "wrap times beyond the clip's end, for both clips (else clamp)")
        .needs(clip);
    Option blend =
        command.add_option("--blend", options.blend, "name or number of a second clip to blend with").needs(clip);
    command.add_option("--blend-time", options.blend_time_s, "seconds into the second clip")
        .needs(blend)
        .check(finite())
        .capture_default_str();
    command.add_option("--weight", options.weight, "weight of --clip; the second clip has the rest")
        .needs(blend)
        .check(finite())
        .check(range(0.0, 1.0))
        .capture_default_str();
    add_error_option(command, options.compile);
    add_scan_option(command, options.scan);
    command.add_flag("--reference", options.reference, "compute on the CPU in double precision; needs no GPU");
    command
        .add_option("--vertices", options.vertices,
                    "skinned vertices of each primitive to print: a number, spread evenly, or 'all'")
        .capture_default_str();
    add_device_option(command, options.device);
    command.add_flag("--json", options.json, "as JSON: matrices column-major, positions in world space");
    command.footer(
        "Examples:\n  throng pose fox.glb --clip Walk --time 0.3\n"
        "  throng pose fox.glb --clip Walk --time 0.3 --blend Run --blend-time 0.5 --weight 0.25 --loop --vertices all "
        "--json\n"
        "  throng pose fox.glb --clip 0 --time 1 --reference --json");
}

}  // namespace throng::tools
