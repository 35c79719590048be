#include <throng/character.h>

#include "base/failure.h"
#include "base/find_name.h"
#include "base/finite.h"
#include "base/progress.h"
#include "bind/bind_reference.h"
#include "compile/asset_check.h"
#include "compile/file/character_check.h"
#include "compile/file/character_file.h"
#include "compile/file/character_layout.h"
#include "compile/clip/read_clips.h"
#include "compile/clip/clip_bounds.h"
#include "reference/sampled_poses.h"
#include "reference/influence_boxes.h"
#include "compile/mesh/lod.h"
#include "compile/rig/joint_lod.h"
#include "compile/mesh/mesh.h"
#include "compile/mesh/morph.h"
#include "compile/clip/pack.h"
#include "compile/rig/rig.h"
#include "compile/clip/root_motion.h"
#include "compile/rig/uniform_scale.h"
#include "base/read_file.h"
#include "import/read_asset.h"
#include "json/known_names.h"
#include "skin/skin_reference.h"

#include <algorithm>
#include <limits>
#include <optional>
#include <span>

namespace throng {
namespace {

// Sets the bounds and the size: of the mesh in the rest pose, or of the joints if there is no mesh.
void measure(Character& character) {
    const std::vector<AffineT<double>> model = rest_model_from_joint(character.rig);
    std::vector<double> weights;
    for (const Morph& morph : character.morphs) weights.push_back(morph.default_weight);
    std::vector<Vec3<double>> points = skin_reference(character, bind_reference(character.palette, model),
                                                      active_morphs_reference(weights));
    if (points.empty())
        for (const AffineT<double>& m : model) points.push_back({m.row[0][3], m.row[1][3], m.row[2][3]});

    constexpr double kInfinity = std::numeric_limits<double>::infinity();
    Box bounds{{kInfinity, kInfinity, kInfinity}, {-kInfinity, -kInfinity, -kInfinity}, false};
    const auto refuse_rest = [&] {
        throw Failure(ErrorCode::kInvalidFile, character.name, "the rest pose is not finite");
    };
    for (const Vec3<double>& point : points) {
        if (!all_finite(point)) refuse_rest();
        bounds.add(point);
    }
    character.bounds_min = bounds.low.as<float>();
    character.bounds_max = bounds.high.as<float>();
    character.size = static_cast<float>(length(bounds.high - bounds.low));
    if (character.size == 0) character.size = 1;  // joints without a mesh, all in one place
    if (!std::isfinite(character.size)) refuse_rest();
}

// Rough share of the work that is done after each step of compiling an asset; kLoaded: after load_character() has
// imported it.
constexpr double kMeshCompiled = 0.05, kClipsRead = 0.1, kRootMotionExtracted = 0.15, kLodsMade = 0.6,
                 kClipsPacked = 0.95;
constexpr double kLoaded = 0.1;

// Clips are packed while levels of detail are made: the poses of these are sampled from exact clips beforehand.
void write_clips_and_lods(std::span<const ExactClip> clips, const CompileSettings& settings, Character& character,
                          const Progress& progress) {
    std::vector<MeshPose> poses;
    if (settings.lods)
        poses = mesh_poses(
            character, kLodPoses,
            [&](const SampledPose& pose) { return sample_exact(clips[pose.clip], character.rig, pose.time_s); },
            progress);
    std::optional<ClipPacking> packing;
    if (settings.error > 0)
        packing.emplace(clips, settings.error, character, progress.between(kLodsMade, kClipsPacked));
    else
        write_exact(clips, character);
    if (settings.lods) make_lods(character, poses, progress.between(kRootMotionExtracted, kLodsMade));
    if (packing) packing->finish();
}

Result<Character> compile(const Asset& asset, const CompileSettings& settings, const Progress& progress) {
    return as_result(
        [&] {
            check_error_bound(settings.error, asset.name);
            progress.report(0);
            check_asset(asset);
            Character character;
            character.name = asset.name;
            character.warnings = asset.warnings;
            const RigMap map = build_rig(asset);
            character.rig = map.rig;
            compile_mesh(asset, map, character, progress.between(0, kMeshCompiled));
            compile_morphs(asset, character, progress);
            measure(character);
            std::vector<ExactClip> clips = read_clips(asset, map, character,
                                                      progress.between(kMeshCompiled, kClipsRead));
            if (!settings.root_motion_joint.empty())
                extract_root_motion(clips, settings.root_motion_joint, character,
                                    progress.between(kClipsRead, kRootMotionExtracted));
            for (const ExactClip& clip : clips) character.clips.push_back(clip.facts);
            compile_morph_tracks(asset, character, progress);  // before packing: how far vertices reach depends on it
            write_clips_and_lods(clips, settings, character, progress);
            character.rig.uniform_scale = has_uniform_scale(character);
            if (settings.lods) make_joint_lods(character, progress);
            measure_clips(character, progress.between(kClipsPacked, 1));
            file::visit_strings(character, [](std::string& text) { text = printable(text, std::string::npos); });
            // Catches, for example, numbers so large that results computed from them are not finite
            check_character(character, asset.name, ErrorCode::kInvalidFile);
            progress.report(1);
            return character;
        },
        asset.name);
}

// Reads what save_character() wrote.
Character read_compiled(const std::filesystem::path& path, const std::string& place, const Progress& progress) {
    constexpr double kRead = 0.5;
    const std::vector<std::byte> bytes = read_file(path, kCompiledFileLimit_bytes, place, kLargerThanFiles,
                                                   progress.between(0, kRead));
    Character character = read_character(bytes, place);
    progress.report(1);
    return character;
}

}  // namespace

JointIndex Rig::find_joint(std::string_view joint_name) const { return find_name(names, joint_name); }
ClipIndex Character::find_clip(std::string_view clip_name) const { return find_name(clips, clip_name); }
uint32_t Character::find_morph(std::string_view morph_name) const { return find_name(morphs, morph_name); }
uint32_t Character::find_material(std::string_view material_name) const { return find_name(materials, material_name); }
Result<JointIndex> Rig::joint_named(std::string_view joint_name) const {
    return index_named<JointIndex>("rig", "joint", names, joint_name);
}
Result<ClipIndex> Character::clip_named(std::string_view clip_name) const {
    return index_named<ClipIndex>(name, "clip", clips, clip_name);
}
Result<uint32_t> Character::morph_named(std::string_view morph_name) const {
    return index_named(name, "morph", morphs, morph_name);
}

std::vector<uint32_t> Character::find_sections(std::string_view section_name) const {
    return find_all_names(section_names, section_name);
}

std::vector<uint32_t> Character::find_sections_of_material(std::string_view material_name) const {
    std::vector<uint32_t> found;
    for (uint32_t i = 0; i < sections.size(); ++i)
        if (sections[i].material < materials.size() && materials[sections[i].material].name == material_name)
            found.push_back(i);
    return found;
}

Result<Character> compile_character(const Asset& asset, const CompileSettings& settings, const LoadHooks& hooks) {
    return compile(asset, settings, Progress(hooks));
}

Result<Character> load_character(const std::filesystem::path& path, const CompileSettings& settings,
                                 const LoadHooks& hooks) {
    const Progress progress(hooks);
    if (is_compiled_file(path)) {
        const std::string place = printable(path.filename().string(), 120);
        return as_result([&] { return read_compiled(path, place, progress); }, place);
    }
    Result<Asset> asset = gltf::load_asset(path, progress.between(0, kLoaded));
    if (!asset) return asset.error();
    return compile(*asset, settings, progress.between(kLoaded, 1));
}

}  // namespace throng
