// libFuzzer entry: an Asset that an application has filled itself, with mistakes; then crowds of the compiled
// character, in which the application may have changed anything.
#include "tests/fuzz/fuzz_crowd.h"
#include "tests/fuzz/mistakes.h"

#include <algorithm>
#include <chrono>
#include <span>
#include <string_view>

using namespace throng;
using fuzz::Input;

namespace {

// Returns how many mistakes it has made.
uint32_t make_mistakes(Input& in, auto& value) {
    const auto count = in.ConsumeIntegralInRange<uint32_t>(0, 4);
    for (uint32_t i = 0; i < count; ++i) fuzz::change(in, value);
    return count;
}

// ---- Assets without mistakes

float number(Input& in) { return static_cast<float>(in.ConsumeIntegral<int8_t>()) / 32; }
Vec3<float> vector(Input& in) { return {number(in), number(in), number(in)}; }
uint32_t index_of(Input& in, const auto& list) {
    return in.ConsumeIntegralInRange<uint32_t>(0, static_cast<uint32_t>(list.size() - 1));
}
uint32_t index_or_none(Input& in, const auto& list) {
    return list.empty() || !in.ConsumeBool() ? kNone : index_of(in, list);
}

void add_nodes(Input& in, Asset& asset) {
    const auto count = in.ConsumeIntegralInRange<uint32_t>(1, 8);
    for (uint32_t i = 0; i < count; ++i) {
        const auto above = in.ConsumeIntegralInRange<uint32_t>(0, i);
        AssetNode& node = asset.nodes.emplace_back();
        node.name = std::to_string(i);
        node.parent = above < i ? above : kNone;
        node.parent_from_node.translation = vector(in).as<double>();
        node.parent_from_node.rotation = normalized(Quaternion<double>{number(in), number(in), number(in)});
        const Vec3<double> scale = vector(in).as<double>();
        node.parent_from_node.scale = in.ConsumeBool() ? scale : Vec3<double>{scale.x, scale.x, scale.x};
    }
    if (!in.ConsumeBool()) return;
    std::ranges::reverse(asset.nodes);  // so that parents come after their children
    for (AssetNode& node : asset.nodes)
        if (node.parent != kNone) node.parent = count - 1 - node.parent;
}

void add_skins(Input& in, Asset& asset) {
    asset.skins.resize(in.ConsumeIntegralInRange<size_t>(0, 2));
    for (AssetSkin& skin : asset.skins) {
        skin.inverse_binds.resize(in.ConsumeIntegralInRange<size_t>(1, 4));
        for (Affine& bind : skin.inverse_binds) {
            skin.joints.push_back(index_of(in, asset.nodes));
            for (auto& row : bind.row) row[3] = number(in);
        }
    }
}

void add_materials(Input& in, Asset& asset) {
    constexpr std::string_view kTwoPixels(
        "\x89PNG\r\n\x1a\n\0\0\0\rIHDR\0\0\0\2\0\0\0\1\b\0\0\0\0\xd1I V\0\0\0\vIDATx\xda\x63p8\0\0\1C\1\1\x96\xb5\0\x9b"
        "\0\0\0\0IEND\xae\x42`\x82",
        68);
    const auto png = std::as_bytes(std::span(kTwoPixels));
    if (in.ConsumeBool()) asset.images.push_back({.name = "grey", .encoded = {png.begin(), png.end()}});
    asset.materials.resize(in.ConsumeIntegralInRange<size_t>(0, 2));
    for (AssetMaterial& material : asset.materials) {
        visit_images([&](auto member) { material.*member = index_or_none(in, asset.images); });
        material.alpha_mode = in.PickValueInArray({AlphaMode::kOpaque, AlphaMode::kMask, AlphaMode::kBlend});
        material.wrap_u = in.PickValueInArray({TextureWrap::kRepeat, TextureWrap::kClamp, TextureWrap::kMirror});
        material.filter = in.PickValueInArray({TextureFilter::kLinear, TextureFilter::kNearest});
    }
}

// A grid: two triangles, or so many that there are levels of detail.
AssetPrimitive make_primitive(Input& in, const Asset& asset, size_t target_count) {
    AssetPrimitive primitive{.material = index_or_none(in, asset.materials)};
    const uint32_t width = in.ConsumeBool() ? 8 : 1;  // in squares
    for (uint32_t row = 0; row <= width; ++row)
        for (uint32_t column = 0; column <= width; ++column) {
            primitive.positions.push_back({static_cast<float>(column), static_cast<float>(row), number(in)});
            if (row == width || column == width) continue;
            const uint32_t a = row * (width + 1) + column, b = a + 1, c = a + width + 1, d = c + 1;
            primitive.indices.insert(primitive.indices.end(), {a, b, c, c, b, d});
        }
    const size_t count = primitive.positions.size();
    if (in.ConsumeBool()) primitive.normals.assign(count, {0, 0, 1});
    if (in.ConsumeBool()) primitive.texcoords.assign(count, {number(in), number(in)});
    if (in.ConsumeBool()) primitive.colors.assign(count, {1, 0.5f, 0, 1});
    size_t joint_count = asset.nodes.size();  // that all skins have
    for (const AssetSkin& skin : asset.skins) joint_count = std::min(joint_count, skin.joints.size());
    primitive.influence_count = 4 * in.ConsumeIntegralInRange<uint32_t>(0, 2);
    for (size_t i = 0; i < count * primitive.influence_count; ++i) {
        primitive.influence_joints.push_back(static_cast<uint16_t>(i % joint_count));
        primitive.influence_weights.push_back(static_cast<float>(i % 5));
    }
    primitive.targets.resize(target_count);
    for (AssetMorphTarget& target : primitive.targets) {
        if (in.ConsumeBool()) target.positions.assign(count, vector(in));
        if (in.ConsumeBool()) target.normals.assign(count, vector(in));
    }
    return primitive;
}

void add_meshes(Input& in, Asset& asset) {
    asset.meshes.resize(in.ConsumeIntegralInRange<size_t>(1, 2));
    for (AssetMesh& mesh : asset.meshes) {
        mesh.weights.assign(in.ConsumeIntegralInRange<size_t>(0, 3), number(in));
        const auto primitive_count = in.ConsumeIntegralInRange<size_t>(1, 2);
        while (mesh.primitives.size() < primitive_count)
            mesh.primitives.push_back(make_primitive(in, asset, mesh.weights.size()));
    }
    const size_t shown_count = std::min<size_t>(in.ConsumeIntegralInRange<size_t>(1, 3), asset.nodes.size());
    for (uint32_t node = 0; node < shown_count; ++node)
        asset.mesh_instances.push_back(
            {.node = node, .mesh = index_of(in, asset.meshes), .skin = index_or_none(in, asset.skins)});
}

// Adds keys to a track of the clip. `width`: how many numbers a value has.
void add_keys(Input& in, size_t width, auto& track, AssetClip& clip) {
    track.interpolation = in.PickValueInArray(
        {Interpolation::kLinear, Interpolation::kStep, Interpolation::kCubicSpline});
    const size_t values_of_key = track.interpolation == Interpolation::kCubicSpline ? 3 : 1;
    const auto key_count = in.ConsumeIntegralInRange<uint32_t>(1, 4);
    for (uint32_t key = 0; key < key_count; ++key) track.times_s.push_back(0.25f * static_cast<float>(key));
    track.values.resize(key_count * values_of_key * width);
    for (float& value : track.values) value = number(in);
    clip.duration_s = std::max(clip.duration_s, double{track.times_s.back()});
}

void add_clips(Input& in, Asset& asset) {
    asset.clips.resize(in.ConsumeIntegralInRange<size_t>(0, 3));
    for (AssetClip& clip : asset.clips) {
        for (uint32_t node = 0; node < asset.nodes.size(); ++node)
            for (const TrackTarget target : {TrackTarget::kTranslation, TrackTarget::kRotation, TrackTarget::kScale}) {
                if (in.ConsumeIntegralInRange(0, 3) < 3) continue;
                clip.tracks.push_back({.node = node, .target = target});
                add_keys(in, target == TrackTarget::kRotation ? 4 : 3, clip.tracks.back(), clip);
            }
        for (const AssetMeshInstance& instance : asset.mesh_instances) {
            if (!in.ConsumeBool()) continue;
            clip.morph_tracks.push_back({.node = instance.node});
            add_keys(in, asset.meshes[instance.mesh].weights.size(), clip.morph_tracks.back(), clip);
        }
    }
}

Asset make_asset(Input& in) {
    Asset asset;
    add_nodes(in, asset);
    add_skins(in, asset);
    add_materials(in, asset);
    add_meshes(in, asset);
    add_clips(in, asset);
    return asset;
}

// Adds the meshes and clips of another asset, which may have mistakes of its own: then `asset` stays as it is.
void add_another(Input& in, Asset& asset) {
    Asset other = make_asset(in);
    make_mistakes(in, other);
    for (const auto add : {throng::add_meshes, throng::add_clips})
        if (const Result<void> added = add(asset, other); !added) fuzz::check_is_one_line(added.error());
}

// ---- What is made of them

CompileSettings settings_for(Input& in, const Asset& asset) {
    CompileSettings settings{.error = in.PickValueInArray({1e-4, 0.0, 0.1}), .lods = in.ConsumeBool()};
    if (!asset.skins.empty() && in.ConsumeBool())
        settings.root_motion_joint = asset.nodes[asset.skins[0].joints[0]].name;
    return settings;
}

// Cancels what takes long: a clip may need millions of rows, which is no mistake.
Result<Character> compile(const Asset& asset, const CompileSettings& settings) {
    using Clock = std::chrono::steady_clock;
    const Clock::time_point end = Clock::now() + std::chrono::seconds(2);
    return compile_character(asset, settings, {.is_cancelled = [end] { return Clock::now() > end; }});
}

CrowdSettings settings_for(Input& in, const Character& character) {
    CrowdSettings settings{.groups = {{.character = &character, .instance_count = 2}}};
    settings.path = in.PickValueInArray({UpdatePath::kAuto, UpdatePath::kStaged});
    settings.skin_format = in.PickValueInArray({SkinFormat::kAffine, SkinFormat::kHalfAffine, SkinFormat::kSimilarity});
    settings.skin_blend = in.PickValueInArray({SkinBlend::kLinear, SkinBlend::kDualQuaternion});
    CrowdGroup& group = settings.groups[0];
    group.morph_limit = in.ConsumeIntegralInRange<uint32_t>(0, 2);
    if (in.ConsumeBool()) settings.culling = Culling{.reduces_joints = true};
    if (settings.culling && in.ConsumeBool()) {
        group.skin_pool = SkinPool{.capacity = 1};
    } else {
        group.pose_capacity = in.ConsumeIntegralInRange<uint32_t>(0, 1);
        if (in.ConsumeBool()) group.sockets = {0};
    }
    return settings;
}

void animate(Input& in, const Character& character, bool is_compiled) {
    Result<Crowd> crowd = Crowd::create(fuzz::device(), settings_for(in, character));
    if (!crowd) {
        fuzz::check_is_one_line(crowd.error());
        if (is_compiled && crowd.error().code == ErrorCode::kInvalidArgument)
            fuzz::abort_with("a compiled character is refused", crowd.error());
        return;
    }
    const InstanceHandle instance{0};
    (void)crowd->set_playback(instance, {.first = {.clip = index_or_none(in, character.clips)},
                                         .second = {.clip = index_or_none(in, character.clips)},
                                         .weight = 0.5f});
    for (uint32_t update = 0; update < 2; ++update) {
        (void)crowd->update(0.3f);
        (void)crowd->read_positions(instance);
        (void)crowd->set_pose(instance, character.rig.rest, 0.1f);
    }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
    Input in(data, size);
    Asset asset = make_asset(in);
    const CompileSettings settings = settings_for(in, asset);
    const bool is_correct = make_mistakes(in, asset) == 0;
    if (in.ConsumeBool()) add_another(in, asset);
    Result<Character> character = compile(asset, settings);
    if (!character) {
        fuzz::check_is_one_line(character.error());
        if (is_correct && character.error().code == ErrorCode::kInvalidArgument)
            fuzz::abort_with("a correct asset is refused", character.error());
        return 0;
    }
    const bool is_compiled = make_mistakes(in, *character) == 0;
    animate(in, *character, is_compiled);
    if (in.ConsumeBool()) fuzz::animate_and_draw(*character);
    return 0;
}
