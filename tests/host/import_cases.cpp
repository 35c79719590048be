#include "tests/host/import_cases.h"

#include "tests/files.h"

#include <algorithm>

namespace throng::test {

Result<Asset> load(const std::string& content, const std::string& name) {
    const TemporaryFolder folder;
    return load_asset(folder.write(name, content));
}
Result<Asset> load(const GlbBuilder& b) { return load(b.glb()); }

Asset loaded(const GlbBuilder& b) {
    const Result<Asset> result = load(b);
    EXPECT_TRUE(result.ok()) << (result.ok() ? "" : result.error().text());
    return result.ok() ? *result : Asset{};
}

bool has_warning(const Asset& asset, const std::string& part) {
    return std::any_of(asset.warnings.begin(), asset.warnings.end(),
                       [&](const std::string& line) { return line.find(part) != line.npos; });
}

void expect_refused(const Result<Asset>& result, ErrorCode code, const std::string& place, const std::string& part) {
    ASSERT_FALSE(result.ok()) << "loaded, but must be refused at " << place;
    const Error& error = result.error();
    EXPECT_EQ(int(error.code), int(code)) << error.text();
    EXPECT_EQ(error.place, place.empty() ? "file.glb" : "file.glb: " + place) << error.text();
    EXPECT_NE(error.message.find(part), std::string::npos) << error.text();
    EXPECT_EQ(error.text().find('\n'), std::string::npos) << error.text();
}
void expect_refused(const GlbBuilder& b, const std::string& place, const std::string& part) {
    expect_refused(load(b), ErrorCode::kInvalidFile, place, part);
}
void expect_limit(const GlbBuilder& b, const std::string& place) { expect_refused(load(b), ErrorCode::kLimit, place); }

bool has_room(gltf::Budget& budget, uint64_t size_bytes) {
    try {
        gltf::TemporaryCharge(budget).add(1, size_bytes, "");
        return true;
    } catch (const Failure&) {
        return false;
    }
}

OpenedBuffers::OpenedBuffers(const GlbBuilder& b)
    : text_(b.json.dump()),
      json_(text_, JsonAuthor::kProgram),
      container_{text_, b.bin},
      buffers(json_.view(), container_, none_, budget) {}

GltfJson& primitive(GlbBuilder& b) { return b.json["meshes"][0]["primitives"][0]; }
GltfJson& attributes(GlbBuilder& b) { return primitive(b)["attributes"]; }
GltfJson& sampler(GlbBuilder& b) { return b.json["animations"][0]["samplers"][0]; }
GltfJson& channel(GlbBuilder& b) { return b.json["animations"][0]["channels"][0]; }

}  // namespace throng::test
