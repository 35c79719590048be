// Loading from memory, with side files from a resolver; progress and cancellation.
#include "import/limits.h"
#include "tests/files.h"
#include "tests/glb_builder.h"
#include "tests/host/character_file_cases.h"
#include "tests/load_listener.h"
#include "tests/shared.h"
#include "tests/text.h"

#include <throng/throng.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <map>
#include <new>
#include <stdexcept>
#include <tuple>
#include <type_traits>
#include <utility>

namespace throng::test {
namespace {

namespace fs = std::filesystem;

using Bytes = std::vector<std::byte>;
using Files = std::map<std::string, std::string, std::less<>>;

std::span<const std::byte> bytes_of(const std::string& content) { return std::as_bytes(std::span(content)); }
Bytes copy_of(const std::string& content) { return {bytes_of(content).begin(), bytes_of(content).end()}; }

// Returns the content of `files`, and records the requested paths.
AssetResolver resolver_of(const Files& files, std::vector<std::string>* asked = nullptr) {
    return [&files, asked](std::string_view path) -> Result<Bytes> {
        if (asked) asked->emplace_back(path);
        const auto found = files.find(path);
        if (found == files.end()) return Error{ErrorCode::kFile, std::string(path), "not in the pak"};
        return copy_of(found->second);
    };
}

Result<Asset> load_gltf(const GlbBuilder& b, const AssetResolver& resolver = {}) {
    return load_asset(bytes_of(b.json.dump()), "file.gltf", resolver);
}

void expect_error(const Result<Asset>& result, ErrorCode code, const std::string& place, const std::string& part) {
    ASSERT_FALSE(result.ok()) << "loaded, but must be refused at " << place;
    const Error& error = result.error();
    EXPECT_EQ(int(error.code), int(code)) << error.text();
    EXPECT_EQ(error.place, place) << error.text();
    EXPECT_TRUE(contains(error.message, part)) << error.text();
    EXPECT_EQ(error.text().find('\n'), std::string::npos) << error.text();
}

// The members of a struct. Adding one fails to compile here: compare it.
auto members_of(const AssetNode& node) {
    const auto& [name, parent, parent_from_node] = node;
    return std::tie(name, parent, parent_from_node);
}
auto members_of(const AssetSkin& skin) {
    const auto& [name, joints, inverse_binds] = skin;
    return std::tie(name, joints, inverse_binds);
}
auto members_of(const AssetTrack& track) {
    const auto& [node, target, interpolation, times_s, values] = track;
    return std::tie(node, target, interpolation, times_s, values);
}
auto members_of(const AssetMorphTrack& track) {
    const auto& [node, interpolation, times_s, values] = track;
    return std::tie(node, interpolation, times_s, values);
}
auto members_of(const AssetClip& clip) {
    const auto& [name, duration_s, tracks, morph_tracks] = clip;
    return std::tie(name, duration_s, tracks, morph_tracks);
}
auto members_of(const AssetMorphTarget& target) {
    const auto& [positions, normals] = target;
    return std::tie(positions, normals);
}
auto members_of(const AssetPrimitive& primitive) {
    const auto& [material, positions, normals, texcoords, colors, influence_count, influence_joints, influence_weights,
                 indices, targets] = primitive;
    return std::tie(material, positions, normals, texcoords, colors, influence_count, influence_joints,
                    influence_weights, indices, targets);
}
auto members_of(const AssetMesh& mesh) {
    const auto& [name, weights, target_names, primitives] = mesh;
    return std::tie(name, weights, target_names, primitives);
}
auto members_of(const AssetMeshInstance& instance) {
    const auto& [node, mesh, skin, weights] = instance;
    return std::tie(node, mesh, skin, weights);
}
auto members_of(const AssetMaterial& material) { return fields_of(material); }
auto members_of(const AssetImage& image) { return fields_of(image); }

// Large arrays of numbers are compared bit for bit.
template <class T>
bool is_same_asset(const T& a, const T& b) {
    if constexpr (std::is_same_v<T, std::string> || std::is_trivially_copyable_v<T>) {
        return a == b;
    } else if constexpr (requires { typename T::value_type; }) {
        using Element = typename T::value_type;
        if constexpr (std::is_trivially_copyable_v<Element>)
            return a.size() == b.size() &&
                   (a.empty() || std::memcmp(a.data(), b.data(), a.size() * sizeof(Element)) == 0);
        else
            return std::ranges::equal(a, b, is_same_asset<Element>);
    } else {
        const auto of_a = members_of(a), of_b = members_of(b);
        return [&]<size_t... kMember>(std::index_sequence<kMember...>) {
            return (is_same_asset(std::get<kMember>(of_a), std::get<kMember>(of_b)) && ...);
        }
        (std::make_index_sequence<std::tuple_size_v<decltype(of_a)>>());
    }
}
void expect_same(const Asset& a, const Asset& b) {
    const auto& [name, nodes, skins, clips, meshes, mesh_instances, materials, images, warnings] = a;
    EXPECT_EQ(name, b.name);
    EXPECT_EQ(warnings, b.warnings);
    EXPECT_TRUE(is_same_asset(nodes, b.nodes));
    EXPECT_TRUE(is_same_asset(skins, b.skins));
    EXPECT_TRUE(is_same_asset(clips, b.clips));
    EXPECT_TRUE(is_same_asset(meshes, b.meshes));
    EXPECT_TRUE(is_same_asset(mesh_instances, b.mesh_instances));
    EXPECT_TRUE(is_same_asset(materials, b.materials));
    EXPECT_TRUE(is_same_asset(images, b.images));
}

// A file with its buffer and images in side files. Two images are the same file, and one is embedded in the text.
struct WithSideFiles {
    WithSideFiles() {
        files["data/my buffer.bin"] = std::string(reinterpret_cast<const char*>(b.bin.data()), b.bin.size());
        files["skin.png"] = "a picture";
        b.json["buffers"][0] = {{"byteLength", b.bin.size()}, {"uri", "data/my%20buffer.bin"}};
        b.json["images"] = {{{"uri", "skin.png"}}, {{"uri", "skin.png"}}, {{"uri", "data:;base64,AAAA"}}};
        for (int i = 0; i < 3; ++i) {
            b.json["textures"].push_back({{"source", i}});
            b.json["materials"].push_back({{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", i}}}}}});
        }
    }

    GlbBuilder b = tiny_character();
    Files files;
};

// ---- From memory ----

TEST(LoadFromMemory, RealFilesMatchThoseOnDisk) {
    const fs::path characters = shared_folder("characters");
    THRONG_SKIP_WITHOUT(characters);
    size_t count = 0;
    for (const auto& entry : fs::recursive_directory_iterator(characters)) {
        const fs::path& path = entry.path();
        if (path.extension() != ".glb" && path.extension() != ".gltf") continue;
        SCOPED_TRACE(path);
        ++count;
        const AssetResolver resolver = [&](std::string_view name) -> Result<Bytes> {
            if (name.starts_with("..")) return Error{ErrorCode::kFile, std::string(name), "leads out of the folder"};
            return copy_of(read_file(path.parent_path() / name));
        };
        const Result<Asset> loaded = load_asset(bytes_of(read_file(path)), path.filename().string(), resolver);
        ASSERT_TRUE(loaded.ok()) << loaded.error().text();
        expect_same(*loaded, load_asset(path).expect());
    }
    EXPECT_GT(count, 0u);
}

TEST(LoadFromMemory, SideFilesComeFromTheResolver) {
    const WithSideFiles made;
    const TemporaryFolder folder;
    for (const auto& [path, content] : made.files) folder.write(path, content);
    std::vector<std::string> asked;
    const Result<Asset> loaded = load_gltf(made.b, resolver_of(made.files, &asked));
    ASSERT_TRUE(loaded.ok()) << loaded.error().text();
    expect_same(*loaded, load_asset(folder.write("file.gltf", made.b.json.dump())).expect());
    EXPECT_EQ(loaded->images.at(0).encoded, copy_of("a picture"));
    EXPECT_EQ(loaded->images.at(1).encoded, copy_of("a picture"));
    EXPECT_EQ(loaded->images.at(2).encoded, Bytes(3));
    std::ranges::sort(asked);
    EXPECT_EQ(asked, (std::vector<std::string>{"data/my buffer.bin", "skin.png"})) << "each once, and no data: URI";
}

TEST(LoadFromMemory, ABufferThatTheResolverDoesNotHandOverIsAnError) {
    const WithSideFiles made;
    const std::string place = "file.gltf: buffers[0].uri";
    const auto with = [&](const AssetResolver& resolver) { return load_gltf(made.b, resolver); };
    expect_error(with(resolver_of({})), ErrorCode::kFile, place, "'data/my buffer.bin'");
    expect_error(with(resolver_of({})), ErrorCode::kFile, place, "not in the pak");
    expect_error(with([](auto) {
                     return Error{ErrorCode::kLimit, "", "too\nlarge"};
                 }),
                 ErrorCode::kLimit, place, "too?large");
    expect_error(with([](auto) -> Result<Bytes> { throw std::runtime_error("pak\nbroken"); }),
                 ErrorCode::kInvalidArgument, place, "threw: pak?broken");
    expect_error(with([](auto) -> Result<Bytes> { throw 5; }), ErrorCode::kInvalidArgument, place, "threw");
    expect_error(with([](auto) -> Result<Bytes> { throw std::bad_alloc(); }), ErrorCode::kOutOfMemory, place,
                 "out of memory");
    const std::string message = "byteLength is " + std::to_string(made.b.bin.size()) + ", but there are 30 bytes";
    expect_error(with([](auto) { return Bytes(30); }), ErrorCode::kInvalidFile, "file.gltf: buffers[0]", message);
    EXPECT_TRUE(with(resolver_of(made.files)).ok()) << "and then as if nothing had been";
}

TEST(LoadFromMemory, AMissingImageIsLeftOut) {
    const WithSideFiles made;
    const auto with = [&](const Result<Bytes>& image) {
        return load_gltf(made.b, [&](std::string_view path) {
            return path == "skin.png" ? image : Result<Bytes>(copy_of(made.files.find(path)->second));
        });
    };
    for (const ErrorCode code : {ErrorCode::kFile, ErrorCode::kInvalidFile}) {
        const Result<Asset> loaded = with(Error{code, "", "not in the pak"});
        ASSERT_TRUE(loaded.ok()) << loaded.error().text();
        EXPECT_TRUE(loaded->images.at(0).encoded.empty());
        ASSERT_EQ(loaded->warnings.size(), 2u);
        EXPECT_TRUE(loaded->warnings[0].starts_with("file.gltf: images[0].uri: 'skin.png'")) << loaded->warnings[0];
        EXPECT_TRUE(contains(loaded->warnings[0], "not in the pak: the texture is left out")) << loaded->warnings[0];
    }
    expect_error(with(Error{ErrorCode::kOutOfMemory, "", "full"}), ErrorCode::kOutOfMemory, "file.gltf: images[0].uri",
                 "full");
}

TEST(LoadFromMemory, OnlyRelativePathsReachTheResolver) {
    GlbBuilder b = tiny_character();
    std::vector<std::string> asked;
    const Files none;
    for (const char* uri :
         {"a/..", "/etc/secret", "%2fetc/secret", "\\secret", "%5C%5Cserver/secret", "c:/secret", "c%3A/secret",
          "c%3Asecret", "./c:/secret", "file:///etc/secret", "http://localhost/x.bin", "a%00.bin", ""}) {
        b.json["buffers"][0] = {{"byteLength", b.bin.size()}, {"uri", uri}};
        expect_error(load_gltf(b, resolver_of(none, &asked)), ErrorCode::kInvalidFile, "file.gltf: buffers[0].uri", "");
        EXPECT_TRUE(asked.empty()) << uri;
    }
}

TEST(LoadFromMemory, TheResolverGetsNormalPaths) {
    GlbBuilder b = tiny_character();
    const Files none;
    for (const auto& [uri, path] :
         {std::pair("...", "..."), std::pair("a..b/c..", "a..b/c.."), std::pair("a/b:c", "a/b:c"),
          std::pair("./a/.b", "a/.b"), std::pair("a//b", "a/b"), std::pair("parts/../skin.png", "skin.png"),
          std::pair("a\\b%5Cc", "a/b/c"), std::pair("100%.bin", "100%.bin"), std::pair("a%zz%20.bin", "a%zz .bin"),
          std::pair("../skin.png", "../skin.png"), std::pair("a/../../b/../skin.png", "../skin.png"),
          std::pair("%2e%2e/%2E./skin.png", "../../skin.png"), std::pair("a\\..\\..%5Cskin.png", "../skin.png")}) {
        std::vector<std::string> asked;
        b.json["buffers"][0] = {{"byteLength", b.bin.size()}, {"uri", uri}};
        expect_error(load_gltf(b, resolver_of(none, &asked)), ErrorCode::kFile, "file.gltf: buffers[0].uri", path);
        EXPECT_EQ(asked, std::vector<std::string>{path}) << uri;
    }
}

TEST(LoadFromMemory, WithoutAResolverThereAreNoSideFiles) {
    WithSideFiles made;
    const TemporaryFolder folder;  // the working directory does not matter
    for (const auto& [path, content] : made.files) folder.write(path, content);
    const fs::path before = fs::current_path();
    fs::current_path(folder.path());
    expect_error(load_gltf(made.b), ErrorCode::kFile, "file.gltf: buffers[0].uri", "needs a resolver");
    made.b.json["buffers"][0].erase("uri");
    const Result<Asset> glb = load_asset(bytes_of(made.b.glb()), "file.glb");
    fs::current_path(before);
    ASSERT_TRUE(glb.ok()) << glb.error().text();
    ASSERT_EQ(glb->warnings.size(), 2u);
    EXPECT_TRUE(contains(glb->warnings[0], "images[0].uri: 'skin.png' cannot be found")) << glb->warnings[0];
    EXPECT_TRUE(load_asset(bytes_of(tiny_character().gltf()), "file.gltf").ok()) << "all in data: URIs";
}

TEST(LoadFromMemory, MessagesContainTheName) {
    const std::string glb = tiny_character().glb();
    const auto load = [&](std::string_view name) { return load_asset(bytes_of(glb), name); };
    EXPECT_EQ(load("pak:/a/fox.glb").expect().name, "pak:/a/fox.glb");
    EXPECT_EQ(load("").expect().name, "");
    EXPECT_EQ(load("a\nb").expect().name, "a?b");
    EXPECT_EQ(load_asset(bytes_of("?"), "pak:/a/fox.glb").error().place, "pak:/a/fox.glb");
    EXPECT_EQ(load_asset(bytes_of("?"), "").error().place, "(no name)");
    EXPECT_EQ(load_asset({}, "none.glb").error().text(), "none.glb: the file is empty");
    EXPECT_LT(load_asset(bytes_of("?"), std::string(5000, 'x')).error().text().size(), 300u);
}

TEST(LoadFromMemory, HasTheSizeLimitOfFiles) {
    const std::byte one{};
    const std::span<const std::byte> huge(&one, gltf::kFileLimitBytes + 1);  // refused before its bytes are read
    expect_error(load_asset(huge, "huge.glb"), ErrorCode::kLimit, "huge.glb", "2 GiB");
}

// ---- Progress and cancellation ----

// The calls that have hooks, each with the name that its errors have.
struct Call {
    const char* name;
    std::function<Result<void>(const LoadHooks&)> run;
};
template <class T>
Result<void> without_value(const Result<T>& result) {
    return result ? Result<void>() : Result<void>(result.error());
}
class LoadHooksTest : public testing::Test {
protected:
    LoadHooksTest() {
        for (const auto& [path, content] : made_.files) folder_.write(path, content);
        gltf_ = folder_.write("file.gltf", text_);
        compiled_ = folder_.path() / "file.throng";
        save_character(load_character(gltf_).expect(), compiled_).expect();
        calls_ = {
            {"file.gltf", [this](const LoadHooks& hooks) { return without_value(load_asset(gltf_, hooks)); }},
            {"memory.gltf",
             [this](const LoadHooks& hooks) {
                 return without_value(load_asset(bytes_of(text_), "memory.gltf", resolver_of(made_.files), hooks));
             }},
            {"file.gltf", [this](const LoadHooks& hooks) { return without_value(load_character(gltf_, {}, hooks)); }},
            {"file.throng",
             [this](const LoadHooks& hooks) { return without_value(load_character(compiled_, {}, hooks)); }}};
    }

    const WithSideFiles made_;
    const std::string text_ = made_.b.json.dump();
    const TemporaryFolder folder_;
    fs::path gltf_, compiled_;
    std::vector<Call> calls_;
};

TEST_F(LoadHooksTest, ProgressRisesToOne) {
    for (const Call& call : calls_) {
        Listener listener;
        ASSERT_TRUE(call.run(listener.hooks()).ok()) << call.name;
        ASSERT_GT(listener.parts.size(), 1u) << call.name;
        EXPECT_EQ(listener.parts.front(), 0) << call.name;
        EXPECT_EQ(listener.parts.back(), 1) << call.name;
        EXPECT_GT(listener.polls, 1u) << call.name;
    }
}

TEST_F(LoadHooksTest, EachHookMayBeMissing) {
    for (const Call& call : calls_) {
        Listener listener;
        EXPECT_TRUE(call.run({.progress = listener.hooks().progress}).ok());
        EXPECT_EQ(listener.parts.back(), 1);
        EXPECT_TRUE(call.run({.is_cancelled = listener.hooks().is_cancelled}).ok());
        EXPECT_GT(listener.polls, 0u);
    }
}

TEST_F(LoadHooksTest, EachPollMayCancel) {
    for (const Call& call : calls_) {
        for (uint64_t yes_at = 0;; ++yes_at) {
            Listener listener{.yes_at = yes_at};
            const Result<void> result = call.run(listener.hooks());
            EXPECT_EQ(result.ok(), !listener.said_yes) << call.name << ", poll " << yes_at;
            if (result.ok()) break;
            EXPECT_EQ(result.error().code, ErrorCode::kCancelled) << result.error().text();
            EXPECT_EQ(result.error().text(), std::string(call.name) + ": cancelled");
            EXPECT_TRUE(listener.parts.empty() || listener.parts.back() < 1) << "not done";
        }
        EXPECT_TRUE(call.run({}).ok()) << "afterwards " << call.name;
    }
}

TEST_F(LoadHooksTest, AnExceptionOfAHookIsAnError) {
    for (const Call& call : calls_) {
        const auto expect = [&](const LoadHooks& hooks, ErrorCode code, const std::string& text) {
            const Result<void> result = call.run(hooks);
            ASSERT_FALSE(result.ok());
            EXPECT_EQ(result.error().code, code);
            EXPECT_EQ(result.error().text(), std::string(call.name) + ": " + text);
        };
        for (const double from : {0.0, 0.3, 0.9}) {
            const auto bound = [&](double part_done) {
                if (part_done >= from) throw std::runtime_error("no\nmore");
            };
            expect({.progress = bound}, ErrorCode::kInvalidArgument, "progress threw: no?more");
        }
        expect({.is_cancelled = []() -> bool { throw 1; }}, ErrorCode::kInvalidArgument, "is_cancelled threw");
        expect({.is_cancelled = []() -> bool { throw std::bad_alloc(); }}, ErrorCode::kOutOfMemory,
               "is_cancelled: out of memory");
    }
}

TEST_F(LoadHooksTest, ProgressOfAFailedLoadStaysBelowOne) {
    Listener listener;
    EXPECT_FALSE(load_asset(bytes_of(text_), "file.gltf", resolver_of({}), listener.hooks()).ok());
    ASSERT_FALSE(listener.parts.empty());
    EXPECT_LT(listener.parts.back(), 1);
}

// ---- Long loops ----

uint64_t polls_of(const std::function<Result<void>(const LoadHooks&)>& call) {
    Listener listener;
    EXPECT_TRUE(call(listener.hooks()).ok());
    return listener.polls;
}
uint64_t polls_of(const std::string& content) {
    return polls_of(
        [&](const LoadHooks& hooks) { return without_value(load_asset(bytes_of(content), "file.glb", {}, hooks)); });
}

TEST(LoadPolls, GrowWithTheFile) {
    GlbBuilder b = tiny_character();
    const uint64_t few = polls_of(b.glb());
    GlbBuilder text = b;
    text.json["extras"] = std::string(4 << 20, 'x');
    EXPECT_GT(polls_of(text.glb()), few + 300) << "the text of a file, looked through and parsed";
    GlbBuilder long_clip = b;
    std::vector<float> times, rotations;
    for (int i = 0; i < 200'000; ++i) {
        times.push_back(float(i));
        rotations.insert(rotations.end(), {0, 0, 0, 1});
    }
    long_clip.json["animations"][0]["samplers"][0] = {{"input", long_clip.add(times, "SCALAR", kFloat)},
                                                      {"output", long_clip.add(rotations, "VEC4", kFloat)}};
    EXPECT_GT(polls_of(long_clip.glb()), few + 20) << "keys";
    GlbBuilder large_mesh = b;
    constexpr size_t kVertices = 200'000;
    auto& primitive = large_mesh.json["meshes"][0]["primitives"][0];
    primitive.erase("indices");  // so that all vertices are kept
    auto& attributes = primitive["attributes"];
    attributes["POSITION"] = large_mesh.add(std::vector<float>(kVertices * 3), "VEC3", kFloat);
    attributes["NORMAL"] = large_mesh.add(std::vector<float>(kVertices * 3, 1), "VEC3", kFloat);
    attributes["JOINTS_0"] = large_mesh.add(std::vector<uint8_t>(kVertices * 4), "VEC4", kUint8);
    attributes["WEIGHTS_0"] = large_mesh.add(std::vector<float>(kVertices * 4), "VEC4", kFloat);
    EXPECT_GT(polls_of(large_mesh.glb()), few + 30) << "vertices";
    EXPECT_GT(polls_of(large_mesh.gltf()), polls_of(large_mesh.glb()) + 1500) << "base64, read as text and decoded";
    const TemporaryFolder folder;
    const fs::path path = folder.write("large.glb", large_mesh.glb());
    EXPECT_GT(polls_of([&](const LoadHooks& hooks) { return without_value(load_asset(path, hooks)); }),
              polls_of(large_mesh.glb()) + 2)
        << "pieces of a file";
}

}  // namespace
}  // namespace throng::test
