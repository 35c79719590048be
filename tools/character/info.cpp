#include "tools/cli/command.h"
#include "tools/cli/kept_characters.h"
#include "tools/cli/options.h"
#include "tools/cli/path_name.h"
#include "tools/commands.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <span>

namespace throng::tools {
namespace {

// Device memory for one more instance: its state, cursors, placement, skin matrices and shown morphs (the arena is
// shared).
size_t instance_bytes(const Character& character) {
    return 36 + 36 + sizeof(Affine) + character.palette.size() * sizeof(Affine) +
           character.morphs.size() * sizeof(ShownMorph);
}

size_t face_count(const Character& character) { return character.indices.size() / 3; }

// A coarser level of detail.
struct Lod {
    size_t faces = 0;
    uint32_t joints = 0;
    double error_percent = 0;  // of the size
};

std::vector<Lod> lods_of(const Character& character) {
    std::vector<Lod> lods;
    const size_t sections = character.sections.size();
    for (uint32_t level = 1; level <= character.lods.size(); ++level) {
        Lod& lod = lods.emplace_back();
        for (const IndexRange& range : std::span(character.lod_ranges).subspan((level - 1) * sections, sections))
            lod.faces += range.index_count / 3;
        const auto moves = [level](uint32_t coarsest) { return coarsest >= level; };
        lod.joints = character.joint_lods.empty()
                         ? character.rig.joint_count()
                         : static_cast<uint32_t>(std::ranges::count_if(character.joint_lods, moves));
        lod.error_percent = 100 * double{character.lods[level - 1].error} / character.size;
    }
    return lods;
}

uint32_t largest_influence_count(const Character& character) {
    uint32_t sets = 0;
    for (const MeshSection& section : character.sections)
        if (section.skin != kNone) sets = std::max(sets, section.influence_sets);
    return sets * 4;
}

// The name of each section's material; empty where it has none.
std::vector<std::string> section_materials(const Character& character) {
    std::vector<std::string> names;
    for (const MeshSection& section : character.sections)
        names.push_back(section.material == kNone ? "" : character.materials[section.material].name);
    return names;
}

// The number of vertices of level of detail 0 for which `counts` is true.
template <class Counts>
size_t vertex_count(const Character& character, const Counts& counts) {
    size_t count = 0;
    for (const MeshSection& section : character.sections)
        count += static_cast<size_t>(std::ranges::count_if(
            std::span(character.vertices).subspan(section.first_vertex, section.own_vertex_count()), counts));
    return count;
}

size_t vertex_count(const Character& character) {
    return vertex_count(character, [](const Vertex&) { return true; });
}

size_t morphed_vertex_count(const Character& character) {
    return vertex_count(character, [](const Vertex& vertex) { return vertex.first_delta > 0; });
}

size_t morphing_clip_count(const Character& character) {
    size_t count = 0;
    for (size_t clip = 0; clip < character.clips.size(); ++clip) {
        const auto tracks =
            std::span(character.morph_tracks).subspan(clip * character.morphs.size(), character.morphs.size());
        if (std::ranges::any_of(tracks, [](uint32_t word) { return word != kNone; })) ++count;
    }
    return count;
}

uint64_t morph_bytes(const Character& character) {
    return character.morph_deltas.size() * sizeof(MorphDelta) +
           (character.morph_tracks.size() + character.morph_times_s.size() + character.morph_values.size()) * 4;
}

// The size, how many times smaller that is than 10 floats per joint and row, and the error if there is one.
std::string compression_text(uint64_t size_bytes, uint64_t raw_size_bytes, double error, bool packed) {
    char size[64], percent[32] = "exact";
    std::snprintf(size, sizeof(size), "%8.1f KiB  %5.1f : 1  ", static_cast<double>(size_bytes) / 1024,
                  static_cast<double>(raw_size_bytes) / static_cast<double>(size_bytes));
    if (packed) std::snprintf(percent, sizeof(percent), "%8.5f %%", error * 100);
    return std::string(size) + percent;
}

nlohmann::json to_json(const Vec3<float>& v) { return {v.x, v.y, v.z}; }

nlohmann::json to_json(const Character& character) {
    nlohmann::json clips = nlohmann::json::array(), skins = nlohmann::json::array();
    for (const Clip& clip : character.clips) {
        clips.push_back({{"name", clip.name},
                         {"duration_s", clip.duration_s},
                         {"channels", clip.channel_count},
                         {"rows", clip.row_count},
                         {"animated_tracks", clip.animated_track_count},
                         {"source_keys", clip.source_key_count},
                         {"refined_rows", clip.refined_row_count},
                         {"dropped_rows", clip.dropped_row_count},
                         {"bytes", clip.size_bytes},
                         {"raw_bytes", clip.raw_size_bytes},
                         {"error_percent", clip.error * 100}});
        if (clip.root_row_count == 0) continue;
        const Cycle cycle(character, clip);
        clips.back()["root_motion"] = {
            {"rows", clip.root_row_count}, {"x", cycle.x}, {"z", cycle.z}, {"turn_degrees", cycle.turn_degrees}};
    }
    for (const Skin& skin : character.skins) skins.push_back({{"name", skin.name}, {"joints", skin.joint_count}});
    nlohmann::json morphs = nlohmann::json::array(), lods = nlohmann::json::array();
    for (const Lod& lod : lods_of(character))
        lods.push_back({{"faces", lod.faces}, {"joints", lod.joints}, {"error_percent", lod.error_percent}});
    for (const Morph& morph : character.morphs)
        morphs.push_back({{"name", morph.name}, {"node", morph.node}, {"weight", morph.default_weight}});
    const Rig& rig = character.rig;
    const ClipTotals totals(character);
    return {{"file", character.name},
            {"joints", rig.joint_count()},
            {"levels", rig.level_count},
            {"mean_depth", rig.mean_depth},
            {"leaves", rig.leaf_count},
            {"uniform_scale", rig.uniform_scale},
            {"skins", skins},
            {"palette_entries", character.palette.size()},
            {"clips", clips},
            {"packed", character.packed},
            {"clip_bytes", totals.size_bytes},
            {"clip_raw_bytes", totals.raw_size_bytes},
            {"error_percent", totals.error * 100},
            {"vertices", vertex_count(character)},
            {"faces", face_count(character)},
            {"sections", character.sections.size()},
            {"section_names", character.section_names},
            {"section_materials", section_materials(character)},
            {"lods", lods},
            {"materials", character.materials.size()},
            {"influences", largest_influence_count(character)},
            {"morph_targets", morphs},
            {"size", character.size},
            {"bounds", {to_json(character.bounds_min), to_json(character.bounds_max)}},
            {"bytes_per_character", morph_bytes(character) + character.keys.size() * 16 + character.words.size() * 4 +
                                        character.times_s.size() * 4 + character.root_rows.size() * 16 +
                                        character.tracks.size() * sizeof(JointTracks)},
            {"bytes_per_instance", instance_bytes(character)},
            {"warnings", character.warnings}};
}

void print_text(const Character& character) {
    const Rig& rig = character.rig;
    std::printf("%s\n", character.name.c_str());
    std::printf("  rig        %u joints, %u levels, mean depth %.1f, %u leaves%s\n", rig.joint_count(), rig.level_count,
                rig.mean_depth, rig.leaf_count, rig.uniform_scale ? ", uniform scale" : "");
    for (size_t i = 0; i < character.skins.size(); ++i)
        std::printf("  skin %-5zu %u joints  %s\n", i, character.skins[i].joint_count, character.skins[i].name.c_str());
    std::printf("  mesh       %zu vertices, %zu faces, %zu sections, %zu materials, up to %u influences a vertex\n",
                vertex_count(character), face_count(character), character.sections.size(), character.materials.size(),
                largest_influence_count(character));
    const Vec3<float> extent = character.bounds_max - character.bounds_min;
    std::printf("  size       %.3g m, of which %.3g wide, %.3g high, %.3g deep, at rest\n",
                static_cast<double>(character.size), static_cast<double>(extent.x), static_cast<double>(extent.y),
                static_cast<double>(extent.z));
    const std::vector<std::string> materials = section_materials(character);
    for (size_t i = 0; i < character.sections.size() && character.sections.size() > 1; ++i)
        std::printf("  section %-2zu %u faces  %s%s%s\n", i, character.sections[i].index_count / 3,
                    character.section_names[i].c_str(), materials[i].empty() ? "" : "  ", materials[i].c_str());
    const std::vector<Lod> lods = lods_of(character);
    for (size_t i = 0; i < lods.size(); ++i)
        std::printf("  lod %-3zu %zu faces, %u joints, off by up to %.2f %% of the size\n", i + 1, lods[i].faces,
                    lods[i].joints, lods[i].error_percent);
    if (!character.morphs.empty())
        std::printf("  morphs     %zu targets, of %zu vertices; animated in %zu of %zu clips\n",
                    character.morphs.size(), morphed_vertex_count(character), morphing_clip_count(character),
                    character.clips.size());
    std::printf("  memory     %zu skin matrices: %zu bytes an instance\n", character.palette.size(),
                instance_bytes(character));
    for (size_t i = 0; i < character.clips.size(); ++i) {
        const Clip& clip = character.clips[i];
        std::printf("  clip %-5zu %7.3f s  %4u channels  %5u rows x %4u tracks  %s  %s", i,
                    static_cast<double>(clip.duration_s), clip.channel_count, clip.row_count, clip.animated_track_count,
                    compression_text(clip.size_bytes, clip.raw_size_bytes, clip.error, character.packed).c_str(),
                    clip.name.c_str());
        if (clip.refined_row_count > 0)
            std::printf("  (%u rows added for cubic tracks%s)", clip.refined_row_count,
                        clip.root_row_count > 0 ? " or root motion" : "");
        if (clip.dropped_row_count > 0) std::printf("  (%u rows left out)", clip.dropped_row_count);
        std::printf("\n");
        if (clip.root_row_count > 0) {
            const Cycle cycle(character, clip);
            // No -0
            const auto rounded = [](double value, double unit) { return std::round(value / unit) * unit + 0.0; };
            std::printf("    moves    %.3f m a cycle, to x %.3f, z %.3f, and turns by %.1f degrees\n",
                        std::hypot(cycle.x, cycle.z), rounded(cycle.x, 1e-3), rounded(cycle.z, 1e-3),
                        rounded(cycle.turn_degrees, 0.1));
        }
    }
    if (!character.clips.empty()) {
        const ClipTotals totals(character);
        std::printf("  all clips  %s\n",
                    compression_text(totals.size_bytes, totals.raw_size_bytes, totals.error, character.packed).c_str());
    }
    for (const std::string& warning : character.warnings) std::printf("  warning    %s\n", warning.c_str());
}

// In the order of the joint numbers, which calls take; masks and rules take the names.
nlohmann::json joints_json(const Rig& rig) {
    nlohmann::json joints = nlohmann::json::array();
    for (uint32_t joint = 0; joint < rig.joint_count(); ++joint) {
        const uint32_t parent = rig.parents[joint];
        joints.push_back(
            {{"name", rig.names[joint]}, {"parent", parent == kNone ? nlohmann::json() : nlohmann::json(parent)}});
    }
    return joints;
}

// As a tree, also in the order of the joint numbers: parents come first.
void print_joints(const Rig& rig) {
    constexpr uint32_t kMaxShown = 40;  // levels; deeper lines are not indented further
    std::vector<uint32_t> levels(rig.joint_count());
    for (uint32_t joint = 0; joint < rig.joint_count(); ++joint) {
        const uint32_t parent = rig.parents[joint];
        levels[joint] = parent == kNone ? 0 : levels[parent] + 1;
        std::printf("  joint %-4u %*s%s\n", joint, static_cast<int>(2 * std::min(levels[joint], kMaxShown)), "",
                    rig.names[joint].c_str());
    }
}

struct InfoOptions {
    std::string file, device;
    uint32_t count = 10'000;
    bool joints = false, json = false;
    CompileSettings compile{.lods = false};
};

void run_info(const InfoOptions& options) {
    const Character character = unwrap(load_kept_character(options.file, options.compile));
    // The file can be described without a device too, but a device that was asked for must exist.
    const Result<Device> device = Device::create({.select = options.device});
    if (!device && !options.device.empty()) throw CommandError(device.error().text());
    nlohmann::json json = options.json ? to_json(character) : nlohmann::json();
    if (options.json && options.joints) json["rig"] = joints_json(character.rig);
    if (!options.json) print_text(character);
    if (!options.json && options.joints) print_joints(character.rig);
    const StreamOrder order = stream_order(character.rig);
    if (options.json)
        json["stream"] = {{"lanes", order.lanes},
                          {"characters", order.characters},
                          {"chunks", order.chunks},
                          {"rounds", order.rounds},
                          {"slots", order.slots}};
    else
        std::printf("  stream     on GPUs: %u chunks of %u joints, %u rounds, %u slots, %u characters side by side\n",
                    order.chunks, order.lanes, order.rounds, order.slots, order.characters);
    if (device) {
        const GroupPath path = unwrap(advise_path(*device, character, options.count));
        const ScanAdvice advice = unwrap(advise_scan(*device, character.rig, options.count));
        const std::string& name = device->info().name;
        if (options.json) {
            json["update"] = {{"path", path_name(path)}, {"reason", path.reason}, {"device", name}};
            json["scan"] = {
                {"method", advice.method}, {"reason", advice.reason}, {"characters", options.count}, {"device", name}};
        } else {
            std::printf("  update     on %s: %s\n", name.c_str(), path.reason.c_str());
            std::printf("  scan       %s on %s: %s\n", advice.method.c_str(), name.c_str(), advice.reason.c_str());
        }
    }
    if (options.json) print_json(json);
}

}  // namespace

void add_info(Command app) {
    Command command = app.add_subcommand(
        "info", "what is in a .glb, .gltf or .throng file, what it costs, and how a crowd of it would be scanned");
    InfoOptions& options = command.options_of(run_info);
    command.add_option("file", options.file, "a glTF 2.0 file, or one that 'throng compile' wrote").required();
    command.add_option("--count", options.count, "number of characters for which a scan method is chosen")
        .check(range(1u, 10'000'000u))
        .capture_default_str();
    add_error_option(command, options.compile);
    add_root_motion_option(command, options.compile);
    add_device_option(command, options.device);
    command.add_flag("--lods", options.compile.lods,
                     "make levels of detail, as 'compile' does, and print them (a compiled file's are always printed)");
    command.add_flag("--joints", options.joints, "list the joints: their numbers, names and parents");
    command.add_flag("--json", options.json, "as JSON");
    command.footer(
        "Examples:\n  throng info fox.glb\n  throng info fox.glb --joints\n  throng info fox.glb --count 100\n  throng "
        "info fox.glb --root-motion "
        "hips\n  throng info fox.glb --lods\n  throng info fox.glb --json | jq .clips");
}

}  // namespace throng::tools
