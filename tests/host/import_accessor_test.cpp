// Accessors: bounds, strides, sparse ones.
#include "import/limits.h"
#include "tests/host/import_cases.h"

namespace throng::test {
namespace {

TEST(Import, AccessorsALittleTooLongAreReadAsFarAsTheyGo) {
    const auto with_colors = [](size_t count, size_t there) {
        GlbBuilder b = tiny_character();
        GltfJson& of = attributes(b);
        of.erase("JOINTS_0");
        of.erase("WEIGHTS_0");
        b.json["nodes"][0].erase("skin");
        primitive(b).erase("indices");
        primitive(b)["mode"] = 5;
        of["POSITION"] = b.add(std::vector<float>(3 * count, 1), "VEC3", kFloat);
        of["NORMAL"] = b.add(std::vector<float>(3 * count, 1), "VEC3", kFloat);
        of["COLOR_0"] = b.add(std::vector<float>(4 * there, 0.5f), "VEC4", kFloat);
        b.json["accessors"].back()["count"] = count;
        return b;
    };
    const Asset asset = loaded(with_colors(20, 18));
    EXPECT_TRUE(has_warning(asset, "accessors[10]: 2 of 20 elements lie beyond its buffer view: they are set to 0"));
    EXPECT_EQ(asset.warnings.size(), 1u);
    const auto& colors = asset.meshes[0].primitives[0].colors;
    ASSERT_EQ(colors.size(), 20u);
    for (size_t v = 0; v < colors.size(); ++v) EXPECT_EQ(colors[v][0], v < 18 ? 0.5f : 0) << v;
    expect_refused(with_colors(20, 17), "accessors[10]", "at most a tenth of them may be missing");
    expect_refused(with_colors(20, 0), "accessors[10]", "do not fit");
    GlbBuilder many = with_colors(20, 18);
    many.json["accessors"].back()["count"] = 4'000'000'000u;
    EXPECT_FALSE(load(many));
}

// Replacing missing keys or matrices with zeros would be worse than leaving them out.
TEST(Import, KeysAndMatricesBeyondABufferViewAreLeftOut) {
    constexpr size_t kCount = 20;
    const auto with_keys = [&](size_t times_there, size_t values_there) {
        GlbBuilder b = tiny_character();
        std::vector<float> times_s(times_there);
        for (size_t i = 0; i < times_there; ++i) times_s[i] = float(i);
        sampler(b)["input"] = b.add(times_s, "SCALAR", kFloat);
        b.json["accessors"].back()["count"] = kCount;
        sampler(b)["output"] = b.add(std::vector<float>(3 * values_there, 1), "VEC3", kFloat);
        b.json["accessors"].back()["count"] = kCount;
        channel(b)["target"]["path"] = "translation";
        return b;
    };
    for (const auto& [times_there, values_there] : {std::pair(18, 20), std::pair(20, 18), std::pair(18, 19)}) {
        const Asset asset = loaded(with_keys(size_t(times_there), size_t(values_there)));
        const AssetTrack& track = asset.clips.at(0).tracks.at(0);
        EXPECT_EQ(track.times_s.size(), 18u);
        EXPECT_EQ(track.values, std::vector<float>(3 * 18, 1));
        EXPECT_EQ(asset.clips[0].duration_s, 17);
        EXPECT_EQ(asset.warnings.size(), size_t(times_there < 20) + size_t(values_there < 20));
        EXPECT_TRUE(has_warning(asset, "2 of 20 elements lie beyond its buffer view: they are left out"));
    }
    expect_refused(with_keys(17, 20), "accessors[8]", "at most a tenth of them may be missing");

    GlbBuilder b = tiny_character();
    b.json["skins"][0]["joints"] = {1, 2, 1, 2, 1, 2, 1, 2, 1, 2};
    b.json["skins"][0]["inverseBindMatrices"] = b.add(std::vector<float>(16 * 9, 1), "MAT4", kFloat);
    b.json["accessors"].back()["count"] = 10;
    expect_refused(b, "skins[0].inverseBindMatrices", "has 9 matrices for 10 joints");

    b = tiny_character();
    primitive(b)["indices"] = b.add(std::vector<uint16_t>(28, 1), "SCALAR", kUint16);
    b.json["accessors"].back()["count"] = 30;
    EXPECT_EQ(loaded(b).meshes[0].primitives[0].indices.size(), 27u);
}

TEST(Import, SparseElementsBeyondABufferViewAreLeftOut) {
    GlbBuilder b = tiny_character();
    std::vector<float> times_s(18);
    for (size_t i = 0; i < times_s.size(); ++i) times_s[i] = float(i);
    const std::vector<uint8_t> indices{17, 19};
    const std::vector<float> values{17.5f, 19};
    const size_t indices_view = b.add_view(std::as_bytes(std::span(indices))),
                 values_view = b.add_view(std::as_bytes(std::span(values)));
    sampler(b)["input"] = b.add(times_s, "SCALAR", kFloat);
    GltfJson& accessor = b.json["accessors"].back();
    accessor["count"] = 20;
    accessor["sparse"] = {{"count", 2},
                          {"indices", {{"bufferView", indices_view}, {"componentType", kUint8}}},
                          {"values", {{"bufferView", values_view}}}};
    sampler(b)["output"] = b.add(std::vector<float>(80, 0.5f), "VEC4", kFloat);
    times_s.back() = 17.5f;
    EXPECT_EQ(loaded(b).clips.at(0).tracks.at(0).times_s, times_s);
    b.bin[size_t(b.json["bufferViews"][indices_view]["byteOffset"]) + 1] = std::byte(20);
    expect_refused(b, "accessors[8].sparse.indices", "index 20, but the accessor has 20 elements");
}

TEST(Import, AccessorBounds) {
    const auto with = [](const char* key, const GltfJson& value) {
        GlbBuilder b = tiny_character();
        b.json["accessors"][kPosition][key] = value;
        return b;
    };
    const std::string place = "accessors[0]";
    expect_refused(with("count", 4), place, "4 elements of 12 bytes from byte 0 do not fit");
    expect_refused(with("count", 2), "meshes[0].primitives[0].indices", "index 2, but there are 2 vertices");
    expect_refused(with("byteOffset", 1), place, "do not fit");
    expect_refused(with("byteOffset", 1ull << 52), place, "do not fit");
    expect_refused(with("byteOffset", -4), place + ".byteOffset", "-4");
    expect_refused(with("byteOffset", 1ull << 60), place + ".byteOffset", "non-negative integer");
    expect_refused(with("bufferView", 99), place + ".bufferView", "index 99");
    expect_refused(with("componentType", 5124), place, "componentType 5124 is unknown");
    expect_refused(with("type", "VEC9"), place, "type 'VEC9' is unknown");
    expect_refused(with("type", 3), place + ".type", "must be a string");
    expect_refused(with("count", 3.5), place + ".count", "3.5");
    expect_limit(with("count", 4294967295u), place);

    const auto with_view = [](const char* key, const GltfJson& value) {
        GlbBuilder b = tiny_character();
        b.json["bufferViews"][0][key] = value;
        return b;
    };
    expect_refused(with_view("byteLength", 35), place, "do not fit into its buffer view of 35 bytes");
    expect_refused(with_view("byteLength", 1 << 20), "bufferViews[0]", "ends at byte 1048576");
    expect_refused(with_view("byteOffset", 4294967280u), "bufferViews[0]", "ends at byte");
    expect_refused(with_view("byteOffset", (1ull << 53) - 1), "bufferViews[0]", "ends at byte");
    expect_refused(with_view("buffer", 1), "bufferViews[0].buffer", "index 1, but buffers has 1 entry");
    expect_refused(with_view("byteStride", 4), place, "byteStride of its buffer view is 4");
    expect_refused(with_view("byteStride", 1ull << 40), place, "byteStride");
}

TEST(Import, Strides) {
    GlbBuilder b = tiny_character();
    const std::vector<float> values{9, 1, 2, 3, 9, 4, 5, 6, 9, 7, 8, 9};
    const size_t view = b.add_view(std::as_bytes(std::span(values)));
    b.json["bufferViews"][view]["byteStride"] = 16;
    const size_t accessor = b.add_accessor(view, 9, "VEC3", kFloat);
    b.json["accessors"][accessor]["byteOffset"] = 4;  // the last element ends at the end of the view
    attributes(b)["POSITION"] = accessor;
    EXPECT_EQ(loaded(b).meshes[0].primitives[0].positions, (std::vector<Vec3<float>>{{1, 2, 3}, {4, 5, 6}, {7, 8, 9}}));
    b.json["accessors"][accessor]["byteOffset"] = 8;
    expect_refused(b, "accessors[8]", "do not fit");
}

TEST(Import, Sparse) {
    GlbBuilder b = tiny_character();
    const std::vector<uint16_t> indices{0, 2};
    const std::vector<float> values{5, 6, 7, 8, 9, 10};
    GltfJson& accessor = b.json["accessors"][kPosition];
    const size_t indices_view = b.add_view(std::as_bytes(std::span(indices))),
                 values_view = b.add_view(std::as_bytes(std::span(values)));
    accessor["sparse"] = {{"count", 2},
                          {"indices", {{"bufferView", indices_view}, {"componentType", kUint16}}},
                          {"values", {{"bufferView", values_view}}}};
    EXPECT_EQ(loaded(b).meshes[0].primitives[0].positions,
              (std::vector<Vec3<float>>{{5, 6, 7}, {1, 0, 0}, {8, 9, 10}}));
    accessor.erase("bufferView");  // zeros
    EXPECT_EQ(loaded(b).meshes[0].primitives[0].positions,
              (std::vector<Vec3<float>>{{5, 6, 7}, {0, 0, 0}, {8, 9, 10}}));
    const GltfJson good = accessor["sparse"];
    accessor["sparse"]["count"] = 4;
    expect_refused(b, "accessors[0].sparse", "count is 4, but the accessor has 3 elements");
    accessor["sparse"]["count"] = 3;
    expect_refused(b, "accessors[0].sparse.indices", "do not fit");
    accessor["sparse"] = good;
    accessor["sparse"]["indices"]["componentType"] = kFloat;
    expect_refused(b, "accessors[0].sparse.indices", "must be unsigned integers");
    accessor["sparse"] = good;
    accessor["sparse"]["values"]["bufferView"] = 99;
    expect_refused(b, "accessors[0].sparse.values.bufferView", "index 99");
    accessor["sparse"] = good;
    accessor["sparse"]["values"]["byteOffset"] = 4;
    expect_refused(b, "accessors[0].sparse.values", "do not fit");
    accessor["sparse"] = good;
    b.bin[size_t(b.json["bufferViews"][indices_view]["byteOffset"])] = std::byte(3);
    expect_refused(b, "accessors[0].sparse.indices", "index 3, but the accessor has 3 elements");
}

TEST(Import, AmplificationIsBounded) {
    // An accessor without data takes no space in the file.
    GlbBuilder b = tiny_character();
    b.json["accessors"].push_back({{"componentType", kFloat}, {"count", 400'000'000}, {"type", "VEC3"}});
    attributes(b) = {{"POSITION", 8}};
    expect_limit(b, "meshes[0].primitives[0].attributes.POSITION");
    b.json["accessors"][8]["sparse"] = {
        {"count", 0}, {"indices", {{"bufferView", 0}, {"componentType", kUint8}}}, {"values", {{"bufferView", 0}}}};
    expect_limit(b, "accessors[8]");
    // Nor do many primitives that share one accessor.
    b.json["accessors"][8] = {{"componentType", kFloat}, {"count", 1'000'000}, {"type", "VEC3"}};
    primitive(b).erase("indices");
    const GltfJson one = primitive(b);
    for (int i = 0; i < 1000; ++i) b.json["meshes"][0]["primitives"].push_back(one);
    const auto result = load(b);
    ASSERT_FALSE(result.ok());
    EXPECT_EQ(result.error().code, ErrorCode::kLimit);
    // Nor do many sets of influences. All of them together are refused.
    b.json["meshes"][0]["primitives"] = GltfJson::array({one});
    b.json["accessors"].push_back({{"componentType", kUint8}, {"count", 1'000'000}, {"type", "VEC4"}});
    b.json["accessors"].push_back({{"componentType", kFloat}, {"count", 1'000'000}, {"type", "VEC4"}});
    for (int set = 0; set < 100; ++set) {
        attributes(b)["JOINTS_" + std::to_string(set)] = 9;
        attributes(b)["WEIGHTS_" + std::to_string(set)] = 10;
    }
    expect_limit(b, "meshes[0].primitives[0].attributes");
}

// The memory limit grows with the file's size.
TEST(Import, MemoryIsLimitedByTheSizeOfTheFile) {
    constexpr uint64_t kMiB = uint64_t{1} << 20;
    gltf::Budget small(1000), large(100 * kMiB);
    small.charge(384 * kMiB, "");
    EXPECT_THROW(small.charge(1, ""), Failure);
    large.charge(1100 * kMiB, "");
    large.charge(100 * kMiB, "");
    try {
        large.charge(uint64_t{1} << 53, 4096, "meshes[0]");
        ADD_FAILURE() << "overflow";
    } catch (const Failure& failure) {
        EXPECT_NE(failure.error.message.find("the limit of 1200 MiB"), std::string::npos) << failure.error.text();
    }
    large.add_file(kMiB);
    large.charge(12 * kMiB, "");
    EXPECT_THROW(large.charge(1, ""), Failure);
}

TEST(Import, MemoryThatIsFreedIsGivenBack) {
    gltf::Budget budget(1000);
    auto bytes = gltf::charged_bytes(budget, 1000, 12, "");
    EXPECT_EQ(bytes->size(), 12'000u);
    const auto is_empty = [&] { return has_room(budget, gltf::kMemoryLimitBytes); };
    auto also = bytes;
    bytes.reset();
    EXPECT_FALSE(is_empty()) << "somebody still holds them";
    also.reset();
    // Decoded data has its own limit. In the last round, 12,000 bytes are missing.
    for (uint64_t round = 1; round < gltf::kDecodedOfMemory; ++round) EXPECT_TRUE(is_empty()) << round;
    try {
        budget.charge(gltf::kMemoryLimitBytes, "meshes[0]");
        ADD_FAILURE() << "decoded without end";
    } catch (const Failure& failure) {
        EXPECT_EQ(failure.error.code, ErrorCode::kLimit);
        EXPECT_EQ(failure.error.place, "meshes[0]");
        EXPECT_NE(failure.error.message.find("the limit of 6144 MiB"), std::string::npos) << failure.error.text();
    }
}

}  // namespace
}  // namespace throng::test
