// Loading of files that tests build, and expectations about the result.
#pragma once

#include "import/container.h"
#include "json/json_text.h"
#include "tests/glb_builder.h"

#include <throng/throng.h>

#include <gtest/gtest.h>

#include <cstring>
#include <string>

namespace throng::test {

Result<Asset> load(const std::string& content, const std::string& name = "file.glb");
Result<Asset> load(const GlbBuilder& b);
// Loads a file that must be valid.
Asset loaded(const GlbBuilder& b);
bool has_warning(const Asset& asset, const std::string& part);

// Expects a refusal in one line that names the place and contains `part`.
void expect_refused(const Result<Asset>& result, ErrorCode code, const std::string& place,
                    const std::string& part = "");
void expect_refused(const GlbBuilder& b, const std::string& place, const std::string& part = "");
void expect_limit(const GlbBuilder& b, const std::string& place);

// The file's first primitive, its attributes, and the first sampler and channel.
GltfJson& primitive(GlbBuilder& b);
GltfJson& attributes(GlbBuilder& b);
GltfJson& sampler(GlbBuilder& b);
GltfJson& channel(GlbBuilder& b);

// Whether the budget allows `size_bytes` more.
bool has_room(gltf::Budget& budget, uint64_t size_bytes);

// A file's buffers as readers see them, and the budget that they count against.
class OpenedBuffers {
public:
    explicit OpenedBuffers(const GlbBuilder& b);

    JsonView root() const { return json_.view(); }

private:
    const std::string text_;
    const JsonText json_;
    const gltf::Container container_;
    const gltf::SideFiles none_;

public:
    gltf::Budget budget{0};
    gltf::Buffers buffers;
};

template <class T>
void overwrite(GlbBuilder& b, size_t accessor, size_t component, T value) {
    const size_t offset = b.json["bufferViews"][size_t(b.json["accessors"][accessor]["bufferView"])]["byteOffset"];
    std::memcpy(b.bin.data() + offset + component * sizeof(T), &value, sizeof(T));
}

}  // namespace throng::test
