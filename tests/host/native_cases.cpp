#include "tests/host/native_cases.h"

#include "sample/sample_reference.h"
#include "tools/creatures/creature.h"

#include <cstring>
#include <limits>

namespace throng::test {
namespace {

void add(std::vector<NamedCharacter>& all, const std::string& name, const Asset& asset) {
    for (const double error : {0.0, 1e-4})
        if (auto character = compile_character(asset, {.error = error, .lods = false}))
            all.push_back({name + (error > 0 ? " packed" : " exact"), *std::move(character)});
}

io::ClipCursor cursor_of(const Character& character, const ClipPlayback& playback) {
    return cursor_reference(playback, character.clips, character.times_s, character.rig.joint_count());
}

}  // namespace

const std::vector<NamedCharacter>& native_characters() {
    static const std::vector<NamedCharacter> characters = [] {
        std::vector<NamedCharacter> all;
        const auto folder = shared_folder("characters");
        if (std::filesystem::exists(folder))
            for (const auto& file : std::filesystem::recursive_directory_iterator(folder))
                if (file.path().extension() == ".glb" || file.path().extension() == ".gltf")
                    add(all, file.path().stem().string(), *load_asset(file.path()));
        for (const CreatureKind kind : {CreatureKind::kDragon, CreatureKind::kWillow, CreatureKind::kWalker}) {
            CreatureSettings settings = creature_settings(kind);
            settings.face_count = 300;
            add(all, "creature " + std::to_string(static_cast<int>(kind)), *make_creature(settings));
        }
        for (const RigShape shape : kRigShapes)
            for (const double spread : {0.0, 0.2}) {
                const std::string name = std::string(name_of(shape)) + (spread > 0 ? ", three scales" : "");
                add(all, name, make_asset({.joint_count = 37, .shape = shape, .scale_spread = spread}));
            }
        for (const uint32_t joint_count : {1u, 16u, 17u})
            add(all, std::to_string(joint_count) + " joints", make_asset({.joint_count = joint_count}));
        return all;
    }();
    return characters;
}

io::InstanceCursor cursor_of(const Character& character, const Playback& playback) {
    return {cursor_of(character, playback.first), cursor_of(character, playback.second), playback.weight};
}

namespace {

// Between rotations half a turn apart there are two shortest ways, and rounding chooses one.
bool has_two_ways(const Character& character, const Playback& playback) {
    const auto pose = [&](const ClipPlayback& of) {
        if (of.clip == kNone) return sample_reference(character, static_cast<uint32_t>(character.clips.size()), 0);
        return sample_reference(character, of.clip,
                                local_time_reference(of.time_s, character.clips[of.clip].duration_s, of.loop));
    };
    const std::vector<Trs<double>> first = pose(playback.first), second = pose(playback.second);
    for (size_t joint = 0; joint < first.size(); ++joint)
        if (std::abs(dot(first[joint].rotation, second[joint].rotation)) < 1e-3) return true;
    return false;
}

}  // namespace

Playback random_playback(const Character& character, Random& random) {
    const auto play = [&] {
        const uint32_t clip = random.below(static_cast<uint32_t>(character.clips.size()) + 1);
        if (clip == character.clips.size()) return ClipPlayback{};
        return ClipPlayback{.clip = clip,
                            .time_s = random.between(0, 1.1 * character.clips[clip].duration_s),
                            .loop = random.chance(0.5)};
    };
    Playback playback{.first = play(), .second = play(), .weight = static_cast<float>(random.unit())};
    if (random.chance(0.1)) playback.weight = 0;
    if (random.chance(0.1)) playback.weight = 1;
    return has_two_ways(character, playback) ? random_playback(character, random) : playback;
}

GuardedBytes::GuardedBytes(size_t size) : size_(size), bytes_(native::aligned_bytes(size + 2 * kGuard)) {
    std::memset(bytes_.get(), 0xA5, size + 2 * kGuard);
    std::memset(data(), 0xFF, size);
}

GuardedBytes::~GuardedBytes() {
    for (size_t i = 0; i < kGuard; ++i) {
        EXPECT_EQ(bytes_[i], std::byte{0xA5}) << "a guard word in front";
        EXPECT_EQ(bytes_[kGuard + size_ + i], std::byte{0xA5}) << "a guard word behind";
    }
}

double displacement(const Character& character, std::span<const Affine> skin, const ReferencePose& wanted) {
    ReferencePose got = wanted;
    got.model_from_bind.clear();
    for (const Affine& m : skin) got.model_from_bind.push_back(m.as<double>());
    const std::vector<Vec3<double>> at = reference_positions(character, got),
                                    should = reference_positions(character, wanted);
    double worst = 0;
    for (size_t i = 0; i < at.size(); ++i) worst = worse_of(worst, length(at[i] - should[i]));
    return worst / character.size;
}

}  // namespace throng::test
