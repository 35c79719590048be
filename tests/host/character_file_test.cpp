// Compiled files: they load bit for bit as written, and damaged ones are refused.
#include "base/replace_file.h"
#include "base/crc64.h"
#include "tests/files.h"
#include "tests/host/character_file_cases.h"
#include "tests/shared.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <functional>
#include <limits>

namespace throng {
namespace {

using namespace test;
using namespace file;

// ---- Equality

// Compares bit for bit, and structs with strings field by field.
template <class T>
bool same(const T& a, const T& b) {
    static_assert(std::is_trivially_copyable_v<T>);
    return std::memcmp(&a, &b, sizeof(T)) == 0;
}
template <class T>
bool same(const std::vector<T>& a, const std::vector<T>& b) {
    if constexpr (std::is_trivially_copyable_v<T>)
        return a.size() == b.size() && (a.empty() || std::memcmp(a.data(), b.data(), a.size() * sizeof(T)) == 0);
    else if constexpr (std::is_same_v<T, std::string>)
        return a == b;
    else
        return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                          [](const T& x, const T& y) { return fields_of(x) == fields_of(y); });
}
bool same(const std::string& a, const std::string& b) { return a == b; }
bool same(const Rig& a, const Rig& b) {
    const auto& [names, parents, nodes, rest, level_count, mean_depth, leaf_count, uniform_scale] = a;
    return names == b.names && parents == b.parents && nodes == b.nodes && same(rest, b.rest) &&
           level_count == b.level_count && same(mean_depth, b.mean_depth) && leaf_count == b.leaf_count &&
           uniform_scale == b.uniform_scale;
}

void expect_same(const Character& a, const Character& b) {
    const auto& [name, rig, clips, times_s, packed, keys, words, root_rows, tracks, skins, palette, vertices,
                 influences, indices, sections, section_names, lods, lod_ranges, lod_indices, joint_lods, materials,
                 images, bounds_min, bounds_max, size, morphs, morph_deltas, morph_tracks, morph_times_s, morph_values,
                 warnings] = a;
    EXPECT_TRUE(same(name, b.name));
    EXPECT_TRUE(same(rig, b.rig));
    EXPECT_TRUE(same(clips, b.clips));
    EXPECT_TRUE(same(times_s, b.times_s));
    EXPECT_TRUE(same(packed, b.packed));
    EXPECT_TRUE(same(keys, b.keys));
    EXPECT_TRUE(same(words, b.words));
    EXPECT_TRUE(same(root_rows, b.root_rows));
    EXPECT_TRUE(same(tracks, b.tracks));
    EXPECT_TRUE(same(skins, b.skins));
    EXPECT_TRUE(same(palette, b.palette));
    EXPECT_TRUE(same(vertices, b.vertices));
    EXPECT_TRUE(same(influences, b.influences));
    EXPECT_TRUE(same(indices, b.indices));
    EXPECT_TRUE(same(sections, b.sections));
    EXPECT_TRUE(same(section_names, b.section_names));
    EXPECT_TRUE(same(lods, b.lods));
    EXPECT_TRUE(same(lod_ranges, b.lod_ranges));
    EXPECT_TRUE(same(lod_indices, b.lod_indices));
    EXPECT_TRUE(same(joint_lods, b.joint_lods));
    EXPECT_TRUE(same(materials, b.materials));
    EXPECT_TRUE(same(images, b.images));
    EXPECT_TRUE(same(bounds_min, b.bounds_min));
    EXPECT_TRUE(same(bounds_max, b.bounds_max));
    EXPECT_TRUE(same(size, b.size));
    EXPECT_TRUE(same(morphs, b.morphs));
    EXPECT_TRUE(same(morph_deltas, b.morph_deltas));
    EXPECT_TRUE(same(morph_tracks, b.morph_tracks));
    EXPECT_TRUE(same(morph_times_s, b.morph_times_s));
    EXPECT_TRUE(same(morph_values, b.morph_values));
    EXPECT_TRUE(same(warnings, b.warnings));
}

void expect_same_poses(const Character& a, const Character& b) {
    for (uint32_t clip = 0; clip <= a.clips.size(); ++clip) {
        const bool is_rest = clip == a.clips.size();
        for (const double part : {0.0, 0.37, 1.0}) {
            const Playback playback{
                .first = {is_rest ? kNone : clip, is_rest ? 0 : part * double{a.clips[clip].duration_s}, 1, false}};
            EXPECT_EQ(reference_pose(a, playback)->model_from_bind, reference_pose(b, playback)->model_from_bind);
            EXPECT_EQ(reference_pose(a, playback)->model_from_joint, reference_pose(b, playback)->model_from_joint);
        }
    }
}

void expect_round_trip(const Character& character) {
    const Bytes bytes = write_character(character);
    const Result<Character> again = load(bytes);
    ASSERT_TRUE(again) << again.error().text();
    expect_same(character, *again);
    EXPECT_EQ(write_character(*again), bytes);
}

// ---- Tests

TEST(CharacterFile, TheChecksumMatchesItsSpecification) {
    const std::string text = "123456789";
    const auto bytes = std::as_bytes(std::span(text));
    EXPECT_EQ(crc64(bytes), 0x995DC9BBDF1939FAu);  // the catalogue's check value of CRC-64/XZ
    EXPECT_EQ(crc64({}), 0u);
    for (size_t first = 0; first <= text.size(); ++first)
        EXPECT_EQ(crc64(bytes.subspan(first), crc64(bytes.first(first))), crc64(bytes));
}

TEST(CharacterFile, RigsComeBackBitForBit) {
    for (const double error : kErrors) {
        for (const AssetSettings& settings :
             {AssetSettings{}, AssetSettings{.joint_count = 1, .clip_count = 0},
              AssetSettings{.joint_count = 70, .shape = RigShape::kComb, .clip_count = 1, .key_count = 12},
              AssetSettings{.seed = 3, .scale_spread = 0}, AssetSettings{.clip_count = 1, .cubic = true},
              AssetSettings{.vertex_count = 0}}) {
            const Character character = compiled(make_full_asset(settings), {.error = error});
            EXPECT_EQ(character.packed, error > 0);
            expect_round_trip(character);
        }
    }
}

TEST(CharacterFile, FilesAreRecognizedByTheirFirstBytes) {
    const TemporaryFolder folder;
    for (const double error : kErrors) {
        const Character character = compiled(make_full_asset({}), {.error = error});
        const std::filesystem::path path = folder.path() / "no extension";
        for (int again = 0; again < 2; ++again) {  // the second time replaces the file
            const Result<void> saved = save_character(character, path);
            ASSERT_TRUE(saved) << saved.error().text();
        }
        const std::vector<std::byte> bytes = save_character(character).value();
        EXPECT_TRUE(is_compiled_file(path) && is_compiled_file(bytes));
        EXPECT_FALSE(is_compiled_file(std::span(bytes).first(4)));
        expect_same(character, load_compiled_character(bytes, "in memory").value());
        for (const CompileSettings& settings : {CompileSettings{}, kExact, CompileSettings{.error = 0.01}}) {
            const Result<Character> again = load_character(path, settings);
            ASSERT_TRUE(again) << again.error().text();
            expect_same(character, *again);
            expect_same_poses(character, *again);
        }
    }
    EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder.path()), {}), 1) << "something was left behind";
}

// Under sanitizers, with exact keys only: other tests cover packed keys with generated rigs, and real characters are
// packed for native_characters().
TEST(CharacterFile, RealCharactersComeBackBitForBit) {
    const std::filesystem::path characters = shared_folder("characters");
    THRONG_SKIP_WITHOUT(characters);
    const TemporaryFolder folder;
    int count = 0;
    for (const auto& entry : std::filesystem::recursive_directory_iterator(characters)) {
        if (entry.path().extension() != ".glb" && entry.path().extension() != ".gltf") continue;
        const Result<Asset> asset = load_asset(entry.path());
        if (!asset) continue;  // covered by import_test
        for (const double error : kErrors) {
            if (kSanitized && error > 0) continue;
            const Character character = compiled(*asset, {.error = error});
            const std::filesystem::path path = folder.path() / "character.throng";
            const Result<void> saved = save_character(character, path);
            ASSERT_TRUE(saved) << saved.error().text();
            const Result<Character> again = load_character(path);
            ASSERT_TRUE(again) << again.error().text();
            expect_same(character, *again);
            expect_same_poses(character, *again);
            ++count;
        }
    }
    EXPECT_GT(count, 0);
}

TEST(CharacterFile, EveryDamagedByteIsRefused) {
    for (const double error : kErrors) {
        Bytes bytes = small_file(error);
        ASSERT_TRUE(load(bytes));
        for (size_t i = 0; i < bytes.size(); ++i) {
            for (const unsigned flip : {0x01u, 0x02u, 0x04u, 0x08u, 0x10u, 0x20u, 0x40u, 0x80u, 0xFFu}) {
                // Behind the header the checksum catches every change, by the same code for all nine
                if (kSanitized && i >= sizeof(Header) && flip != 0xFF) continue;
                bytes[i] ^= std::byte(flip);
                const Result<Character> result = load(bytes);
                bytes[i] ^= std::byte(flip);
                ASSERT_FALSE(result) << "byte " << i << " ^ " << flip;
                const std::string text = result.error().text();
                ASSERT_TRUE(text.starts_with("small.throng") && text.find('\n') == text.npos) << text;
            }
        }
    }
}

TEST(CharacterFile, EveryTruncationAndEveryTrailingByteIsRefused) {
    for (const double error : kErrors) {
        const Bytes bytes = small_file(error);
        for (size_t size = 0; size < bytes.size(); ++size) {
            const Bytes cut(bytes.begin(), bytes.begin() + static_cast<ptrdiff_t>(size));
            Result<Character> result = load(cut);
            ASSERT_FALSE(result) << size << " bytes";
            if (size < sizeof(Header)) {
                const std::string named = size < kMagic.size() ? "is not a compiled character"
                                                               : "ends within its header";
                ASSERT_NE(result.error().message.find(named), std::string::npos) << result.error().text();
                continue;
            }
            Forged forged(cut);
            forged.header().size_bytes = size;
            result = load(forged.sealed());
            ASSERT_FALSE(result) << size << " bytes, and its header says so";
            const bool in_table = size < sizeof(Header) + kSectionCount * sizeof(SectionEntry);
            ASSERT_TRUE(!in_table || result.error().text().find("section table") != std::string::npos)
                << result.error().text();
        }
        for (const size_t more : {1u, 15u, 16u, 17u, 4096u}) {
            Forged forged(bytes);
            forged.bytes().resize(bytes.size() + more);
            ASSERT_FALSE(load(forged.bytes())) << more << " more bytes";
            forged.header().size_bytes = forged.bytes().size();
            ASSERT_FALSE(load(forged.sealed())) << more << " more bytes, and its header says so";
        }
    }
}

TEST(CharacterFile, OtherVersionsAreRefusedWithAdvice) {
    for (const bool sealed : {true, false}) {  // another version may have another checksum
        Forged forged(small_file(0));
        forged.header().version = 5;
        Result<Character> result = load(sealed ? forged.sealed() : forged.bytes());
        ASSERT_FALSE(result);
        EXPECT_EQ(result.error().code, ErrorCode::kUnsupported);
        EXPECT_EQ(result.error().text(),
                  "small.throng: has version 5, but this throng reads version 4; compile it again from its source, "
                  "or update throng");
        forged.header().version = 0;
        result = load(sealed ? forged.sealed() : forged.bytes());
        ASSERT_FALSE(result);
        EXPECT_EQ(result.error().text(),
                  "small.throng: has version 0, but this throng reads version 4; compile it again from its source");
    }
}

// The shader assumes the minimum and step of full rotations, and does not read them.
TEST(CharacterFile, CraftedFullRotationsAreRefused) {
    Asset asset = make_asset(
        {.name = "turning.glb", .joint_count = 1, .clip_count = 1, .key_count = 2, .vertex_count = 6});
    AssetTrack turn{.node = 0, .target = TrackTarget::kRotation};
    for (int key = 0; key < 50; ++key) {
        const Quaternion<double> q = axis_angle(normalized(Vec3<double>{1, 2, 3}), 0.2 * key);
        turn.times_s.push_back(static_cast<float>(key));
        for (const double c : {q.x, q.y, q.z, q.w}) turn.values.push_back(static_cast<float>(c));
    }
    asset.clips[0].tracks = {turn};
    asset.clips[0].duration_s = turn.times_s.back();
    const Character good = compiled(asset, {.error = 1e-4});
    const uint32_t position = good.tracks[0].rotation;
    uint32_t layout = 0;
    std::memcpy(&layout, &good.keys[position][3], 4);
    ASSERT_TRUE(layout & kPackedFull);
    expect_round_trip(good);
    for (const size_t c : {0u, 1u, 2u})
        for (const uint32_t half : {0u, 1u}) {
            Character bad = good;
            bad.keys[position + half][c] = std::nextafter(bad.keys[position + half][c], 1.0f);
            const Result<void> saved = save_character(bad, "/nowhere/none.throng");
            ASSERT_FALSE(saved);
            EXPECT_NE(saved.error().text().find("a full rotation, but its minimum or step is not"), std::string::npos)
                << saved.error().text();
        }
}

// Scans that store rotations apart from scales rely on this flag.
TEST(CharacterFile, UniformScaleIsLookedAtInEveryRow) {
    Asset asset = make_asset({.joint_count = 1, .scale_spread = 0, .clip_count = 1, .key_count = 2, .vertex_count = 6});
    AssetTrack grow{.node = 0, .target = TrackTarget::kScale};
    for (int key = 0; key < 20; ++key) {
        grow.times_s.push_back(static_cast<float>(key));
        grow.values.insert(grow.values.end(), 3, 1 + 0.3f * std::sin(static_cast<float>(key)));
    }
    asset.clips[0].tracks = {grow};
    asset.clips[0].duration_s = grow.times_s.back();
    for (const double error : kErrors) {
        const Character good = compiled(asset, {.error = error});
        ASSERT_TRUE(good.rig.uniform_scale);
        expect_round_trip(good);
        for (uint32_t row = 0; row < good.clips[0].row_count; ++row) {
            Character bad = good;
            if (bad.packed)
                bad.words[bad.clips[0].first_row + row * bad.clips[0].row_stride] ^= 1;
            else
                bad.keys[(bad.tracks[0].scale & kTrackPosition) + row * bad.clips[0].row_stride][2] += 0.01f;
            const Result<void> saved = save_character(bad, "/nowhere/none.throng");
            ASSERT_FALSE(saved) << row;
            EXPECT_NE(saved.error().text().find("not uniform"), std::string::npos) << saved.error().text();
            bad.rig.uniform_scale = false;
            expect_round_trip(bad);
        }
    }
}

TEST(CharacterFile, InvalidCharactersAreNotWritten) {
    const TemporaryFolder folder;
    const Character good = compiled(make_full_asset({}));
    const auto expect_unsaved = [&](const char* named, const std::function<void(Character&)>& change) {
        Character character = good;
        change(character);
        const Result<void> saved = save_character(character, folder.path() / "none.throng");
        ASSERT_FALSE(saved) << named;
        EXPECT_EQ(saved.error().code, ErrorCode::kInvalidArgument) << saved.error().text();
        EXPECT_NE(saved.error().text().find(named), std::string::npos) << saved.error().text();
    };
    expect_unsaved("no joints", [](Character& c) { c = {}; });
    expect_unsaved("rig: the numbers of names", [](Character& c) { c.rig.names.pop_back(); });
    expect_unsaved("tracks", [](Character& c) { c.tracks.pop_back(); });
    expect_unsaved("times", [](Character& c) { c.times_s.push_back(9); });
    expect_unsaved("indices[", [](Character& c) { c.indices.back() = 1000; });
    Result<void> saved = save_character(good, folder.path() / "nowhere" / "none.throng");
    ASSERT_FALSE(saved);
    EXPECT_EQ(saved.error().code, ErrorCode::kFile);
    saved = save_character(good, folder.path());
    ASSERT_FALSE(saved);
    EXPECT_EQ(saved.error().code, ErrorCode::kFile);
    EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
}

TEST(CharacterFile, LimitsAreNamed) {
    const Character good = compiled(make_full_asset({}));
    const auto expect_limit = [&](const char* named, const std::function<void(Character&)>& change) {
        Character character = good;
        change(character);
        const Result<void> saved = save_character(character, "/nowhere/none.throng");
        ASSERT_FALSE(saved) << named;
        EXPECT_EQ(saved.error().code, ErrorCode::kLimit);
        EXPECT_NE(saved.error().message.find(named), std::string::npos) << saved.error().text();
    };
    expect_limit("the limit is 65535", [](Character& c) { c.rig.parents.resize(65'536, kNone); });
    expect_limit("the limit is 65536", [](Character& c) { c.palette.resize(65'537); });
    for (const Character& character : {good, compiled(make_full_asset({}), {.error = 1e-4})}) {
        const uint64_t size_bytes = write_character(character).size();
        EXPECT_EQ(write_character(character, size_bytes).size(), size_bytes);
        for (const uint64_t limit_bytes : {uint64_t{1000}, size_bytes / 2, size_bytes - 1}) {
            const Result<Bytes> refused = as_result([&] { return write_character(character, limit_bytes); });
            ASSERT_FALSE(refused);
            EXPECT_EQ(refused.error().code, ErrorCode::kLimit);
            EXPECT_NE(refused.error().message.find("the limit is " + std::to_string(limit_bytes)), std::string::npos)
                << refused.error().text();
        }
    }
    expect_limit("the limit is 268435456", [](Character& c) { c.words.resize((size_t{64} << 20) + 1); });
}

TEST(CharacterFile, MessagesStayOneLine) {
    const Result<Character> result = load_compiled_character(std::as_bytes(std::span("neither this nor that")), "a\nb");
    ASSERT_FALSE(result);
    EXPECT_EQ(result.error().text().find('\n'), std::string::npos) << result.error().text();

    EXPECT_EQ(compiled(make_full_asset({})).materials[1].name, "a?b?");
    Character character = compiled(make_full_asset({}));
    character.name = "a\nb";
    const Result<void> saved = save_character(character, "/nowhere/none.throng");
    ASSERT_FALSE(saved);
    EXPECT_EQ(saved.error().code, ErrorCode::kInvalidArgument);
    EXPECT_NE(saved.error().message.find("control characters"), std::string::npos) << saved.error().text();
    EXPECT_EQ(saved.error().text().find('\n'), std::string::npos) << saved.error().text();
}

TEST(CharacterFile, FilesAreReplacedAsAWhole) {
    const TemporaryFolder folder;
    const std::filesystem::path path = folder.path() / "file", other = folder.path() / "other";
    const auto write = [&](const std::filesystem::path& to, const std::string& text) {
        return as_result([&] { replace_file(to, std::as_bytes(std::span(text))); });
    };
    // A file or link that already has the temporary name must not be touched.
    std::ofstream(other) << "other";
    const std::filesystem::path taken = path.string() + ".part" + std::to_string(getpid()) + ".0";
    std::filesystem::create_symlink(other, taken);
    for (const std::string text : {"long text", "", "short"}) {
        const Result<void> written = write(path, text);
        ASSERT_TRUE(written) << written.error().text();
        EXPECT_EQ(read_file(path), text);
    }
    EXPECT_EQ(read_file(other), "other");
    EXPECT_TRUE(std::filesystem::is_symlink(taken));
    const Result<void> nowhere = write(folder.path() / "nowhere" / "file", "text");
    ASSERT_FALSE(nowhere);
    EXPECT_EQ(nowhere.error().code, ErrorCode::kFile);
    EXPECT_NE(nowhere.error().message.find("No such file or directory"), std::string::npos) << nowhere.error().text();
    create_file(path, std::as_bytes(std::span("new", 3)));
    EXPECT_EQ(read_file(path), "short") << "what is there stays";
    std::filesystem::remove(path);
    create_file(path, std::as_bytes(std::span("new", 3)));
    EXPECT_EQ(read_file(path), "new");
    EXPECT_THROW(create_file(folder.path() / "nowhere" / "file", {}), Failure);
    EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder.path()), {}), 3);
}

TEST(CharacterFile, LinksStayLinksAndPrivateFilesPrivate) {
    namespace fs = std::filesystem;
    const TemporaryFolder folder;
    fs::create_directory(folder.path() / "data");
    const fs::path file = folder.path() / "data" / "file", link = folder.path() / "link",
                   dangling = folder.path() / "new";
    std::ofstream(file) << "old";
    constexpr fs::perms kPrivate = fs::perms::owner_read | fs::perms::owner_write;
    fs::permissions(file, kPrivate);
    fs::create_symlink("data/file", link);
    fs::create_symlink(folder.path() / "data" / "new", dangling);
    for (const fs::path& path : {link, dangling}) {
        replace_file(path, std::as_bytes(std::span("new", 3)));
        EXPECT_TRUE(fs::is_symlink(path));
        EXPECT_EQ(read_file(path), "new");
    }
    EXPECT_EQ(fs::status(file).permissions(), kPrivate);
    fs::create_symlink("circle", folder.path() / "circle");
    EXPECT_THROW(replace_file(folder.path() / "circle", {}), Failure);
}

}  // namespace
}  // namespace throng
