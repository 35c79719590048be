// The native engine against the double-precision reference, with every instruction set that the machine supports.
#include "bind/skin_format.h"
#include "tests/host/native_cases.h"

#include <algorithm>
#include <cstdio>
#include <thread>

namespace throng {
namespace {

using namespace test;

constexpr double kNativeBound = 1e-5;  // as a fraction of the character's size; 2e-5 m for a man

struct Scene {
    Scene(const Character& of, uint32_t count, uint64_t seed) : character(of) {
        Random random(seed);
        for (uint32_t i = 0; i < count; ++i) {
            playbacks.push_back(random_playback(character, random));
            cursors.push_back(cursor_of(character, playbacks.back()));
        }
    }
    size_t instance_bytes(SkinFormat format) const {
        return character.palette.size() * (format == SkinFormat::kAffine       ? 48
                                           : format == SkinFormat::kHalfAffine ? 24
                                                                               : 32);
    }
    std::vector<std::byte> skin(const NativeRig& rig, NativeIsa isa, SkinFormat format = SkinFormat::kAffine) const {
        const auto count = static_cast<uint32_t>(playbacks.size());
        GuardedBytes bytes(count * instance_bytes(format));
        update(rig, {.cursors = cursors.data(), .skin_format = format, .skin = bytes.data()}, 0, count, isa);
        return {bytes.content().begin(), bytes.content().end()};
    }

    const Character& character;
    std::vector<Playback> playbacks;
    std::vector<io::InstanceCursor> cursors;
};

TEST(Native, TwoClipsFollowTheReference) {
    double worst_of_all = 0;
    for (const NamedCharacter& named : native_characters()) {
        const Character& character = named.character;
        const NativeRig rig(character);
        const Scene scene(character, 37, 1);
        for (const NativeIsa isa : native_isas()) {
            const std::vector<std::byte> bytes = scene.skin(rig, isa);
            const std::vector<Affine> skin = unpack_skin(SkinFormat::kAffine, bytes);
            const size_t stride = character.palette.size();
            double worst = 0;
            for (size_t i = 0; i < scene.playbacks.size(); ++i)
                worst = std::max(worst, displacement(character, std::span(skin).subspan(i * stride, stride),
                                                     *reference_pose(character, scene.playbacks[i])));
            EXPECT_LT(worst, kNativeBound) << named.name << " " << name_of(isa);
            std::printf("%-36s %-8s %.1e  rows %8llu bytes\n", named.name.c_str(), name_of(isa).data(), worst,
                        static_cast<unsigned long long>(rig.row_bytes()));
            worst_of_all = std::max(worst_of_all, worst);
        }
    }
    std::printf("largest displacement %.1e\n", worst_of_all);
}

TEST(Native, UpdatingPartsGivesTheSameBits) {
    for (const size_t k : {size_t{0}, native_characters().size() / 2, native_characters().size() - 1}) {
        const Character& character = native_characters()[k].character;
        const NativeRig rig(character);
        const Scene scene(character, 101, 2);
        for (const SkinFormat format : {SkinFormat::kAffine, SkinFormat::kHalfAffine})
            for (const NativeIsa isa : native_isas()) {
                const std::vector<std::byte> whole = scene.skin(rig, isa, format);
                GuardedBytes by_threads(whole.size());
                std::vector<std::thread> threads;
                for (uint32_t t = 0; t < 7; ++t)
                    threads.emplace_back([&, t] {
                        update(rig, {.cursors = scene.cursors.data(), .skin_format = format, .skin = by_threads.data()},
                               101 * t / 7, 101 * (t + 1) / 7, isa);
                    });
                for (std::thread& thread : threads) thread.join();
                EXPECT_TRUE(std::ranges::equal(whole, by_threads.content())) << name_of(isa) << " by threads";
                for (const uint32_t part : {1u, 2u, 7u, 16u, 33u}) {
                    GuardedBytes bytes(whole.size());
                    for (uint32_t first = 0; first < 101; first += part)
                        update(rig, {.cursors = scene.cursors.data(), .skin_format = format, .skin = bytes.data()},
                               first, std::min(101u, first + part), isa);
                    EXPECT_TRUE(std::equal(whole.begin(), whole.end(), bytes.content().begin()))
                        << native_characters()[k].name << " " << name_of(isa) << " in parts of " << part;
                }
            }
    }
}

TEST(Native, OtherFormatsHoldTheSameMatrices) {
    for (const NamedCharacter& named : native_characters()) {
        const NativeRig rig(named.character);
        const Scene scene(named.character, 33, 3);
        for (const SkinFormat format : {SkinFormat::kHalfAffine, SkinFormat::kSimilarity}) {
            if (!skin_format_unsupported_reason(format, named.character).empty()) continue;
            for (const NativeIsa isa : native_isas()) {
                const std::vector<Affine> wanted = unpack_skin(SkinFormat::kAffine, scene.skin(rig, isa)),
                                          got = unpack_skin(format, scene.skin(rig, isa, format));
                const double size = named.character.size, bound = format == SkinFormat::kHalfAffine ? 0x1p-11 : 1e-5;
                double worst = 0;
                for (size_t i = 0; i < got.size(); ++i)
                    for (size_t r = 0; r < 3; ++r)
                        for (size_t c = 0; c < 4; ++c) {
                            const double value = wanted[i].row[r][c];
                            const double unit = format == SkinFormat::kHalfAffine
                                                    ? std::max(std::abs(value), 0x1p-14)
                                                    : (c == 3 ? size : std::max(1.0, std::abs(value)));
                            worst = worse_of(worst, std::abs(got[i].row[r][c] - value) / unit);
                        }
                EXPECT_LE(worst, bound) << named.name << " " << name_of(isa) << " format " << static_cast<int>(format);
            }
        }
    }
}

TEST(Native, ModelMatricesAndSocketsAreThoseOfTheJoints) {
    for (const NamedCharacter& named : native_characters()) {
        const Character& character = named.character;
        const uint32_t joints = character.rig.joint_count();
        const std::vector<uint32_t> sockets{joints - 1, 0, joints / 2};
        const NativeRig rig(character, {.keeps_model = true, .sockets = sockets});
        const Scene scene(character, 19, 4);
        for (const NativeIsa isa : native_isas()) {
            GuardedBytes skin(19 * scene.instance_bytes(SkinFormat::kAffine)), model(19 * 48 * joints),
                at_sockets(19 * 48 * 3);
            update(rig,
                   {.cursors = scene.cursors.data(),
                    .skin = skin.data(),
                    .model = reinterpret_cast<Affine*>(model.data()),
                    .sockets = reinterpret_cast<Affine*>(at_sockets.data())},
                   0, 19, isa);
            const std::vector<Affine> got = unpack_skin(SkinFormat::kAffine, model.content()),
                                      held = unpack_skin(SkinFormat::kAffine, at_sockets.content());
            double worst = 0;
            for (size_t i = 0; i < 19; ++i) {
                const ReferencePose pose = *reference_pose(character, scene.playbacks[i]);
                for (size_t j = 0; j < joints; ++j) {
                    const double scale = std::cbrt(std::abs(determinant(pose.model_from_joint[j])));
                    worst = std::max(worst, matrix_error(got[i * joints + j], pose.model_from_joint[j],
                                                         character.size * std::max(scale, 1e-3)));
                }
                for (size_t s = 0; s < 3; ++s)
                    EXPECT_EQ(held[i * 3 + s], got[i * joints + sockets[s]]) << named.name << " " << name_of(isa);
            }
            EXPECT_LT(worst, 1e-4) << named.name << " " << name_of(isa);
        }
    }
}

TEST(Native, OnlyListedInstancesAreUpdated) {
    const Character& character = native_characters().front().character;
    const NativeRig rig(character);
    const Scene scene(character, 300, 5);
    const size_t stride = scene.instance_bytes(SkinFormat::kAffine);
    std::vector<uint32_t> listed;
    for (uint32_t i = 0; i < 300; ++i)
        if (i % 3 == 1 || i > 250) listed.push_back(i);
    for (const NativeIsa isa : native_isas()) {
        const std::vector<std::byte> all = scene.skin(rig, isa);
        GuardedBytes bytes(all.size());
        const auto count = static_cast<uint32_t>(listed.size());
        update(rig, {.cursors = scene.cursors.data(), .skin = bytes.data(), .listed = listed.data()}, 0, count, isa);
        for (uint32_t i = 0; i < 300; ++i) {
            const auto part = bytes.content().subspan(i * stride, stride);
            if (std::ranges::binary_search(listed, i))
                EXPECT_TRUE(std::ranges::equal(part, std::span(all).subspan(i * stride, stride))) << i;
            else
                EXPECT_TRUE(std::ranges::all_of(part, [](std::byte b) { return b == std::byte{0xFF}; })) << i;
        }
    }
}

TEST(Native, ALevelOfDetailUpdatesOnlyItsJoints) {
    Character character = compiled(make_asset({.joint_count = 60, .scale_spread = 0}));
    const uint32_t joints = character.rig.joint_count();
    character.joint_lods.assign(joints, 0);
    for (uint32_t joint = 0; joint < joints; ++joint) {  // a child's is not above its parent's
        const uint32_t parent = character.rig.parents[joint];
        character.joint_lods[joint] = parent == kNone ? 3 : joint % 3 ? character.joint_lods[parent] : 0;
    }
    const Scene scene(character, 40, 6);
    const NativeRig all(character), some(character, {.lod = 1});
    for (const NativeIsa isa : native_isas()) {
        const std::vector<Affine> wanted = unpack_skin(SkinFormat::kAffine, scene.skin(all, isa)),
                                  got = unpack_skin(SkinFormat::kAffine, scene.skin(some, isa));
        size_t written = 0;
        for (size_t i = 0; i < got.size(); ++i) {
            const bool moves = character.joint_lods[character.palette[i % character.palette.size()].joint] >= 1;
            if (!moves) {
                EXPECT_TRUE(std::isnan(got[i].row[0][0]));
                continue;
            }
            ++written;
            EXPECT_LT(matrix_error(got[i], wanted[i].as<double>(), character.size), 1e-5);
        }
        EXPECT_GT(written, 0u);
        EXPECT_LT(written, got.size());
    }
}

TEST(Native, ReportsWhatIsUnsupported) {
    const Character& character = native_characters().front().character;
    EXPECT_EQ(native_unsupported_reason(character, SkinFormat::kAffine), "");
    const Character uneven = compiled(make_asset({.scale_spread = 0.2}));
    EXPECT_NE(native_unsupported_reason(uneven, SkinFormat::kSimilarity), "");
}

}  // namespace
}  // namespace throng
