// Animation clips: keys, channels and interpolations.
#include "import/readers.h"
#include "tests/host/compile_cases.h"
#include "tests/host/import_cases.h"
#include "tests/shared.h"
#include "tests/test_rig.h"

#include <algorithm>
#include <chrono>
#include <cmath>

namespace throng::test {
namespace {

TEST(Import, Interpolations) {
    GlbBuilder b = tiny_character();
    EXPECT_EQ(loaded(b).clips[0].tracks[0].interpolation, Interpolation::kLinear);
    sampler(b)["interpolation"] = "STEP";
    EXPECT_EQ(loaded(b).clips[0].tracks[0].interpolation, Interpolation::kStep);
    sampler(b)["interpolation"] = "CUBICSPLINE";
    expect_refused(b, "animations[0].samplers[0].output", "has 2 values, but must have 6, for 2 key times");
    sampler(b)["output"] = b.add<float>({0, 0, 0, 0, 0, 0, 0, 1, 9, 9, 9, 9, 8, 8, 8, 8, 0, 0, 1, 0, 0, 0, 0, 0},
                                        "VEC4", kFloat);
    const Asset asset = loaded(b);
    EXPECT_TRUE(asset.warnings.empty());  // a tangent of length zero is valid
    EXPECT_EQ(asset.clips[0].tracks[0].interpolation, Interpolation::kCubicSpline);
    EXPECT_EQ(asset.clips[0].tracks[0].values.size(), 24u);
    sampler(b)["interpolation"] = "BEZIER";
    expect_refused(b, "animations[0].samplers[0].interpolation", "'BEZIER' is unknown");
}

TEST(Import, NormalisedRotations) {
    for (const int type : {kInt8, kInt16, kUint8, kUint16}) {
        GlbBuilder b = tiny_character();
        if (type == kInt8) sampler(b)["output"] = b.add<int8_t>({0, 0, 0, 127, -128, 0, 0, 0}, "VEC4", type);
        if (type == kInt16) sampler(b)["output"] = b.add<int16_t>({0, 0, 0, 32767, -32768, 0, 0, 0}, "VEC4", type);
        if (type == kUint8) sampler(b)["output"] = b.add<uint8_t>({0, 0, 0, 255, 255, 0, 0, 0}, "VEC4", type);
        if (type == kUint16) sampler(b)["output"] = b.add<uint16_t>({0, 0, 0, 65535, 65535, 0, 0, 0}, "VEC4", type);
        expect_refused(b, "animations[0].samplers[0].output", "must be floats or normalised integers");
        b.json["accessors"].back()["normalized"] = true;
        const float one = type == kInt8 || type == kInt16 ? -1.0f : 1.0f;
        EXPECT_EQ(loaded(b).clips[0].tracks[0].values, (std::vector<float>{0, 0, 0, 1, one, 0, 0, 0}));
    }
}

TEST(Import, KeyTimes) {
    const std::string input = "animations[0].samplers[0].input";
    GlbBuilder b = tiny_character();
    const auto with_times = [&](float first, float second) {
        GlbBuilder copy = b;
        overwrite(copy, kTimes, 0, first);
        overwrite(copy, kTimes, 1, second);
        return copy;
    };
    expect_refused(with_times(0, kNan), input, "the time of key 1 is not finite");
    expect_refused(with_times(0, kInfinity), input, "not finite");
    EXPECT_EQ(loaded(with_times(2, 3)).clips[0].duration_s, 3);
    b.json["accessors"][kTimes]["type"] = "VEC2";
    b.json["accessors"][kTimes]["count"] = 1;
    expect_refused(b, input, "must be SCALAR of floats");
    b = tiny_character();
    b.json["accessors"][kTimes]["componentType"] = kUint32;
    expect_refused(b, input, "must be SCALAR of floats");
    b = tiny_character();
    b.json["accessors"][kTimes]["count"] = b.json["accessors"][kRotations]["count"] = 0;
    const Asset none = loaded(b);
    EXPECT_TRUE(none.clips[0].tracks.empty());
    EXPECT_TRUE(has_warning(none, "animations[0].channels[0]: has no keys"));
}

// A clip with one translation track and keys at these times. x is the number of the key, starting at 1.
GlbBuilder with_keys(const std::vector<float>& times_s, const char* interpolation = "LINEAR") {
    GlbBuilder b = tiny_character();
    std::vector<float> values;
    const bool cubic = interpolation == std::string("CUBICSPLINE");
    for (size_t key = 0; key < times_s.size(); ++key) {
        const float x = float(key + 1);
        if (cubic) values.insert(values.end(), {x / 10, 0, 0});
        values.insert(values.end(), {x, 0, 0});
        if (cubic) values.insert(values.end(), {x / 100, 0, 0});
    }
    sampler(b)["input"] = b.add(times_s, "SCALAR", kFloat);
    sampler(b)["output"] = b.add(values, "VEC3", kFloat);
    sampler(b)["interpolation"] = interpolation;
    channel(b)["target"]["path"] = "translation";
    return b;
}

TEST(Import, KeyTimesThatGoBackAreSorted) {
    const std::string input = "animations[0].samplers[0].input: ";
    const auto expect_keys = [&](const GlbBuilder& b, const std::vector<float>& times_s, const std::vector<float>& xs) {
        const Asset asset = loaded(b);
        const AssetTrack& track = asset.clips.at(0).tracks.at(0);
        EXPECT_EQ(track.times_s, times_s);
        std::vector<float> got;
        for (size_t i = 0; i < track.values.size(); i += 3) got.push_back(track.values[i]);
        EXPECT_EQ(got, xs);
        return asset;
    };
    const auto before = [](float time_s) { return std::nextafter(time_s, 0.0f); };

    Asset asset = expect_keys(with_keys({0, 2, 1, 3}), {0, 1, 2, 3}, {1, 3, 2, 4});
    EXPECT_EQ(asset.warnings.size(), 1u);
    EXPECT_TRUE(has_warning(asset, input + "1 of the clip's 4 keys are earlier than the key before them"));
    EXPECT_EQ(asset.clips[0].duration_s, 3);
    asset = expect_keys(with_keys({4, 3, 2, 1}), {1, 2, 3, 4}, {4, 3, 2, 1});
    EXPECT_TRUE(has_warning(asset, input + "3 of the clip's 4 keys are earlier"));
    EXPECT_EQ(asset.clips[0].duration_s, 4);
    expect_keys(with_keys({2, 1}, "STEP"), {1, 2}, {2, 1});
    expect_keys(with_keys({2, 1}, "CUBICSPLINE"), {1, 2}, {0.2f, 2, 0.02f, 0.1f, 1, 0.01f});
    expect_keys(with_keys({5}), {5}, {1});

    // The value jumps at a key time: the interval before ends at the first such key, the interval after begins at the
    // last.
    asset = expect_keys(with_keys({0, 0.5f, 0.5f, 0.5f, 1}), {0, before(0.5f), 0.5f, 1}, {1, 2, 4, 5});
    EXPECT_EQ(asset.warnings.size(), 1u);
    EXPECT_TRUE(has_warning(asset, input + "2 of the clip's 5 keys have the time of another key"));
    asset = expect_keys(with_keys({1, 0.5f, 1, 0.5f}), {before(0.5f), 0.5f, before(1.0f), 1}, {2, 4, 1, 3});
    EXPECT_TRUE(has_warning(asset, input + "2 of the clip's 4 keys are earlier"));
    EXPECT_TRUE(has_warning(asset, input + "2 of the clip's 4 keys have the time"));
    expect_keys(with_keys({1, 1, 2}, "CUBICSPLINE"), {before(1.0f), 1, 2},
                {0.1f, 1, 0.01f, 0.2f, 2, 0.02f, 0.3f, 3, 0.03f});
    // Only the last key is kept for steps, at 0, where floats have no time between, and where the difference is not a
    // normal float.
    expect_keys(with_keys({0, 1, 1, 2}, "STEP"), {0, 1, 2}, {1, 3, 4});
    expect_keys(with_keys({0, 0, 0}), {0}, {3});
    expect_keys(with_keys({before(1.0f), 1, 1}), {before(1.0f), 1}, {1, 3});
    expect_keys(with_keys({1e-39f, 1e-39f}), {1e-39f}, {2});
    expect_keys(with_keys({1e-33f, 1e-33f}), {1e-33f}, {2});
}

// Which of the file's keys to keep is known only while they are read.
TEST(Import, KeySortingMemoryIsGivenBack) {
    GlbBuilder b = tiny_character();
    b.json["buffers"][0]["byteLength"] = b.bin.size();
    overwrite(b, kTimes, 0, 2.0f);
    OpenedBuffers file(b);
    gltf::Warnings warnings("");
    gltf::Accessors accessors(file.root(), file.buffers, file.budget, warnings);
    gltf::Reading reading{file.root(), file.buffers, accessors, file.budget, warnings, false};
    Asset asset;
    asset.nodes.resize(3);
    read_clips(reading, asset);
    ASSERT_EQ(asset.clips.at(0).tracks.at(0).times_s, (std::vector<float>{1, 2}));
    const uint64_t kept_bytes = sizeof(AssetClip) + sizeof(AssetTrack) + 2 * (1 + 4) * sizeof(float);
    EXPECT_TRUE(has_room(file.budget, gltf::kMemoryLimitBytes - kept_bytes));
    EXPECT_FALSE(has_room(file.budget, gltf::kMemoryLimitBytes - kept_bytes + 1));
}

TEST(Import, RepairedKeysGiveOneWarningPerClip) {
    GlbBuilder b = with_keys({0, 2, 1, 1});
    GltfJson& clip = b.json["animations"][0];
    clip["channels"].push_back(channel(b));  // uses the sampler again
    clip["channels"][1]["target"]["node"] = 1;
    clip["channels"].push_back(channel(b));
    clip["channels"][2]["target"]["path"] = "scale";
    clip["channels"][2]["sampler"] = 1;
    clip["samplers"].push_back(sampler(b));
    const Asset asset = loaded(b);
    EXPECT_EQ(asset.warnings.size(), 2u);
    const std::string place = "animations[0].samplers[0].input: ";
    EXPECT_TRUE(has_warning(asset, place + "2 of the clip's 8 keys are earlier"));
    EXPECT_TRUE(has_warning(asset, place + "2 of the clip's 8 keys have the time of another key"));
    EXPECT_TRUE(has_warning(loaded(with_keys({0, 3, 2, 1})), place + "2 of the clip's 4 keys are earlier"));
}

// Keys that share a time play as in three.js. Keys that go back in time play as if they had been sorted.
TEST(Import, RepairedKeysPlay) {
    const auto tip_x = [](const GlbBuilder& b, double time_s) {
        const Character character = *compile_character(loaded(b));
        const auto pose = reference_pose(character, {.first = {.clip = 0, .time_s = time_s, .loop = false}});
        const auto& names = character.rig.names;
        const auto tip = std::find(names.begin(), names.end(), "tip") - names.begin();
        return pose->model_from_joint.at(size_t(tip)).row[0][3];
    };
    constexpr double kBound = 1e-3;  // for packed clips
    const GlbBuilder back = with_keys({0, 2, 1, 3});
    EXPECT_NEAR(tip_x(back, 0.5), 2, kBound);
    EXPECT_NEAR(tip_x(back, 1.5), 2.5, kBound);
    EXPECT_NEAR(tip_x(back, 2.5), 3, kBound);
    const GlbBuilder jump = with_keys({0, 1, 1, 2});
    EXPECT_NEAR(tip_x(jump, 0.5), 1.5, kBound);
    EXPECT_NEAR(tip_x(jump, 0.999), 1.999, kBound);
    EXPECT_NEAR(tip_x(jump, 1), 3, kBound);
    EXPECT_NEAR(tip_x(jump, 1.5), 3.5, kBound);
    EXPECT_NEAR(tip_x(with_keys({1, 1, 1}), 0.5), 1, kBound);
    EXPECT_NEAR(tip_x(with_keys({1, 1, 1}), 1), 3, kBound);
    // Tangents of 0.03 and 0.2 per second between the file's third and second key.
    const double middle = (3 + 2) / 2.0 + (0.03 - 0.2) / 8;
    EXPECT_NEAR(tip_x(with_keys({0, 2, 1, 3}, "CUBICSPLINE"), 1.5), middle, kBound);
}

// ---- Key times before 0

// A clip of one channel with its own sampler. Weights are for the mesh's three morph targets.
GlbBuilder with_curve(const char* path, const char* interpolation, const std::vector<float>& times_s,
                      const std::vector<float>& values) {
    GlbBuilder b = tiny_character();
    const bool are_weights = path == std::string("weights");
    if (are_weights)
        primitive(b)["targets"] = GltfJson::array({{{"POSITION", 0}}, {{"POSITION", 0}}, {{"POSITION", 0}}});
    const char* type = are_weights ? "SCALAR" : path == std::string("rotation") ? "VEC4" : "VEC3";
    sampler(b) = {{"input", b.add(times_s, "SCALAR", kFloat)},
                  {"output", b.add(values, type, kFloat)},
                  {"interpolation", interpolation}};
    channel(b)["target"] = {{"node", are_weights ? 0 : 2}, {"path", path}};
    return b;
}

// The clip's only track, as a track of node 0. Three weights per time are treated like a translation.
AssetTrack curve_of(const AssetClip& clip) {
    AssetTrack out;
    if (!clip.tracks.empty()) {
        out = clip.tracks[0];
    } else {
        const AssetMorphTrack& weights = clip.morph_tracks.at(0);
        out = {.interpolation = weights.interpolation, .times_s = weights.times_s, .values = weights.values};
    }
    out.node = 0;
    return out;
}

TEST(Import, ACurveThatBeginsBeforeZeroIsCutThere) {
    const std::vector<float> times_s{-0.75f, -0.25f, 0.5f, 2};
    const std::vector<float> vectors{1, 2, 3, -1, 4, 0.5f, 3, -2, 1, 0, 0, 2};
    const float half = std::sqrt(0.5f);
    const std::vector<float> rotations{0, 0, 0, 1, 0.6f, 0, 0, 0.8f, 0, -half, 0, -half, half, 0, half, 0};
    struct Case {
        const char* path;
        TrackTarget target;
        const std::vector<float>& values;
    };
    for (const auto& [path, target, plain] :
         {Case{"translation", TrackTarget::kTranslation, vectors}, Case{"rotation", TrackTarget::kRotation, rotations},
          Case{"weights", TrackTarget::kTranslation, vectors}})
        for (const auto& [name, interpolation] :
             {std::pair("LINEAR", Interpolation::kLinear), std::pair("STEP", Interpolation::kStep),
              std::pair("CUBICSPLINE", Interpolation::kCubicSpline)}) {
            SCOPED_TRACE(std::string(path) + ", " + name);
            std::vector<float> values = plain;
            if (interpolation == Interpolation::kCubicSpline) {  // per key, the tangents before and after the value
                values.clear();
                const size_t width = plain.size() / times_s.size();
                for (size_t i = 0; i < plain.size() * 3; ++i)
                    values.push_back(plain[(i / (3 * width) * width + i % width + i / width % 3 * 5) % plain.size()]);
            }
            const Asset asset = loaded(with_curve(path, name, times_s, values));
            ASSERT_EQ(asset.warnings.size(), 1u);
            EXPECT_TRUE(
                has_warning(asset, "animations[0].samplers[0].input: 2 of the clip's 4 keys are before time 0"));
            EXPECT_EQ(asset.clips.at(0).duration_s, 2);
            const AssetClip cut{.tracks = {curve_of(asset.clips[0])}};
            const AssetClip uncut{.tracks = {{.node = 0,
                                              .target = target,
                                              .interpolation = interpolation,
                                              .times_s = times_s,
                                              .values = values}}};
            EXPECT_EQ(cut.tracks[0].times_s, (std::vector<float>{0, 0.5f, 2}));
            for (const double time_s : {0.0, 0.1, 0.3, 0.499, 0.5, 1.1, 2.0, 3.0}) {
                const Trs<double> got = node_trs(asset, 0, &cut, time_s), wanted = node_trs(asset, 0, &uncut, time_s);
                EXPECT_LE(length(got.translation - wanted.translation), 3e-6) << time_s;
                EXPECT_NEAR(std::abs(dot(got.rotation, wanted.rotation)), 1, 1e-6) << time_s;
            }
        }
}

TEST(Import, KeysBeforeZeroAtTheEdges) {
    const auto track_of = [](const GlbBuilder& b) { return loaded(b).clips.at(0).tracks.at(0); };
    AssetTrack track = track_of(with_keys({-1, 0, 1}));
    EXPECT_EQ(track.times_s, (std::vector<float>{0, 1}));
    EXPECT_EQ(track.values, (std::vector<float>{2, 0, 0, 3, 0, 0}));
    track = track_of(with_keys({-1, -0.5f, 1}, "STEP"));
    EXPECT_EQ(track.values, (std::vector<float>{2, 0, 0, 3, 0, 0}));
    track = track_of(with_keys({-2, -1}));
    EXPECT_EQ(track.times_s, std::vector<float>{0});
    EXPECT_EQ(track.values, (std::vector<float>{2, 0, 0}));
    EXPECT_EQ(loaded(with_keys({-2, -1})).clips[0].duration_s, 0);
    track = track_of(with_keys({-2, -1}, "CUBICSPLINE"));
    EXPECT_EQ(track.values, (std::vector<float>{0.2f, 0, 0, 2, 0, 0, 0.02f, 0, 0}));

    // Keys are sorted first. Of several keys at one time, the last one's value goes on.
    GlbBuilder b = with_keys({1, -1, -1});
    const Asset asset = loaded(b);
    EXPECT_EQ(asset.clips[0].tracks[0].values, (std::vector<float>{2, 0, 0, 1, 0, 0}));
    EXPECT_EQ(asset.warnings.size(), 3u);
    b.json["animations"][0]["channels"].push_back(channel(b));  // uses the sampler again
    b.json["animations"][0]["channels"][1]["target"]["node"] = 1;
    EXPECT_TRUE(has_warning(loaded(b), "samplers[0].input: 2 of the clip's 3 keys are before time 0"));

    b = with_curve("translation", "CUBICSPLINE", {-1, 1}, std::vector<float>(18));
    const size_t output = sampler(b)["output"];
    overwrite(b, output, 3, 3e38f);
    overwrite(b, output, 12, -3e38f);
    expect_refused(b, "animations[0].samplers[0].output", "at time 0, where it is cut, is not finite");
}

TEST(Import, KeyValues) {
    const std::string output = "animations[0].samplers[0].output";
    GlbBuilder b = tiny_character();
    overwrite(b, kRotations, 5, kInfinity);
    expect_refused(b, output, "the value of key 1 is not finite");
    b = tiny_character();
    overwrite(b, kRotations, 3, 0.0f);
    EXPECT_TRUE(has_warning(loaded(b), output + ": has a quaternion of length zero"));
    b = tiny_character();
    channel(b)["target"]["path"] = "scale";
    expect_refused(b, output, "must be VEC3, but is VEC4");
    b = tiny_character();
    b.json["accessors"][kRotations]["count"] = 1;
    expect_refused(b, output, "has 1 values, but must have 2");
}

TEST(Import, Channels) {
    GlbBuilder b = tiny_character();
    b.json["animations"][0]["channels"].push_back(channel(b));
    b.json["animations"][0]["channels"][1]["sampler"] = 1;
    GltfJson second = sampler(b);
    second["interpolation"] = "STEP";
    b.json["animations"][0]["samplers"].push_back(second);
    Asset asset = loaded(b);
    ASSERT_EQ(asset.clips[0].tracks.size(), 1u);
    EXPECT_EQ(asset.clips[0].tracks[0].interpolation, Interpolation::kStep);  // the last wins
    EXPECT_TRUE(has_warning(asset, "animations[0].channels[1]: animates what another"));

    b = tiny_character();
    channel(b)["target"].erase("node");
    asset = loaded(b);
    EXPECT_TRUE(asset.clips[0].tracks.empty());
    EXPECT_TRUE(has_warning(asset, "animations[0]: 1 of 1 channels have no target node"));
    channel(b)["target"] = {{"path", "pointer"},
                            {"extensions", {{"KHR_animation_pointer", {{"pointer", "/nodes/0"}}}}}};
    EXPECT_TRUE(has_warning(loaded(b), "KHR_animation_pointer"));
    b = tiny_character();
    channel(b)["target"]["path"] = "colour";
    EXPECT_TRUE(has_warning(loaded(b), "'colour' is unknown"));

    // Weights of a node without morph targets are ignored, and count for the duration.
    b = tiny_character();
    b.json["animations"][0]["samplers"].push_back(
        {{"input", b.add<float>({0, 2.5f}, "SCALAR", kFloat)}, {"output", kTimes}});
    b.json["animations"][0]["channels"].push_back({{"sampler", 1}, {"target", {{"node", 0}, {"path", "weights"}}}});
    asset = loaded(b);
    EXPECT_TRUE(asset.clips[0].morph_tracks.empty());
    EXPECT_TRUE(has_warning(asset, "animations[0].channels[1]: its node has no morph targets"));
    EXPECT_EQ(asset.clips[0].duration_s, 2.5);

    b = tiny_character();
    channel(b)["target"]["node"] = 3;
    expect_refused(b, "animations[0].channels[0].target.node", "index 3, but nodes has 3 entries");
    b = tiny_character();
    channel(b)["sampler"] = 7;
    expect_refused(b, "animations[0].channels[0].sampler", "index 7, but samplers has 1 entry");
    b = tiny_character();
    sampler(b)["input"] = 70;
    expect_refused(b, "animations[0].samplers[0].input", "index 70, but accessors has 8 entries");
    b = tiny_character();
    b.json["animations"][0]["channels"] = GltfJson::array();
    EXPECT_TRUE(has_warning(loaded(b), "animations[0]: has no channels"));
}

TEST(Import, ManyClips) {
    GlbBuilder b = tiny_character();
    const GltfJson clip = b.json["animations"][0];
    for (int i = 0; i < 20'000; ++i) b.json["animations"].push_back(clip);
    const auto start = std::chrono::steady_clock::now();
    EXPECT_EQ(loaded(b).clips.size(), 20'001u);
    EXPECT_LT(std::chrono::steady_clock::now() - start, kHang);
}

}  // namespace
}  // namespace throng::test
