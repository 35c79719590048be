// Side files on disk: which names they may have.
#include "tests/files.h"
#include "tests/host/import_cases.h"

#include <filesystem>

namespace throng::test {
namespace {

namespace fs = std::filesystem;

TEST(ImportUri, UrisCannotLeaveTheFolder) {
    const TemporaryFolder outer;
    const GlbBuilder b = tiny_character();
    const std::string content(reinterpret_cast<const char*>(b.bin.data()), b.bin.size());
    const auto with_uri = [&](const std::string& uri) {
        GlbBuilder copy = b;
        copy.json["buffers"][0] = {{"byteLength", b.bin.size()}, {"uri", uri}};
        return load_asset(outer.write("folder/file.glb", copy.json.dump()));
    };
    for (const char* file : {"folder/data/my.bin", "folder/100% wool.bin", "secret.bin"}) outer.write(file, content);
    for (const char* uri : {"data/../data/my.bin", "not there/../data/my.bin", "./data//my.bin", "data\\my.bin",
                            "data%5c..%5Cdata/my.bin", "100% wool.bin", "100%25 wool.bin", "100%%20wool.bin"})
        EXPECT_TRUE(with_uri(uri).ok()) << uri;

    const std::string place = "buffers[0].uri";
    for (const char* uri : {"data/../../secret.bin", "..\\secret.bin", "data\\..\\../secret.bin", "..%5Csecret.bin",
                            "../folder/data/my.bin"})
        expect_refused(with_uri(uri), ErrorCode::kInvalidFile, place, "leads out of the file's folder by '..'");
    expect_refused(with_uri("data/.."), ErrorCode::kInvalidFile, place, "not a file name");

    // If a backslash is not a separator, a file name can contain one.
    if (fs::path("a\\b").has_parent_path()) return;
    EXPECT_FALSE(with_uri("a\\b.bin").ok());
    outer.write("folder/a\\b.bin", content);
    EXPECT_TRUE(with_uri("a\\b.bin").ok());
    // With the backslash as a plain character this path leads out of the folder; with it as a separator it does not.
    outer.write("folder/x.bin", content);
    EXPECT_TRUE(with_uri("a\\b/../../x.bin").ok());
}

}  // namespace
}  // namespace throng::test
