// The folders of src/ follow docs/architecture.md.
#include "tests/shared.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <regex>
#include <set>
#include <string>

namespace throng {
namespace {

namespace fs = std::filesystem;
const fs::path kSources = fs::path(THRONG_SOURCE_DIR) / "src";

std::string text_of(const fs::path& file) {
    std::ifstream in(file);
    EXPECT_TRUE(in) << file;
    return {std::istreambuf_iterator<char>(in), {}};
}

// For each folder, the other folders whose headers its C++ code includes. Headers shared by C++ and GLSL do not count:
// any folder may include those.
std::map<std::string, std::set<std::string>> folders_included() {
    std::map<std::string, std::set<std::string>> out;
    const std::regex include(R"re(#include "(\w+)/([\w/.]+)")re"), shared(R"(.*(_io\.h|\.glsl))");
    for (const fs::directory_entry& entry : fs::recursive_directory_iterator(kSources)) {
        if (!entry.is_regular_file()) continue;
        const std::string folder = entry.path().lexically_relative(kSources).begin()->string();
        std::set<std::string>& included = out[folder];
        const fs::path type = entry.path().extension();
        if (type != ".h" && type != ".cpp") continue;
        const std::string text = text_of(entry.path());
        for (std::sregex_iterator found(text.begin(), text.end(), include), end; found != end; ++found)
            if ((*found)[1] != folder && fs::is_directory(kSources / (*found)[1].str()) &&
                !std::regex_match((*found)[2].str(), shared))
                included.insert((*found)[1]);
    }
    return out;
}

TEST(Folders, IncludeEachOtherInOneDirection) {
    THRONG_SKIP_WHERE_SANITIZED();
    auto left = folders_included();
    ASSERT_GT(left.size(), 20u);
    ASSERT_TRUE(left.at("crowd").contains("gpu"));
    // Repeatedly removes the folders that include none of the remaining ones, or are included by none: only cycles
    // remain.
    for (size_t before = 0; before != left.size();) {
        before = left.size();
        std::erase_if(left, [&](const auto& folder) {
            const auto& [name, included] = folder;
            const bool includes_some = std::ranges::any_of(included, [&](auto& other) { return left.contains(other); });
            return !includes_some ||
                   std::ranges::none_of(left, [&](auto& other) { return other.second.contains(name); });
        });
    }
    for (const auto& [folder, included] : left)
        for (const std::string& other : included)
            if (left.contains(other)) ADD_FAILURE() << folder << " includes " << other << ", in a circle";
}

TEST(Folders, AreInTheTableOfParts) {
    THRONG_SKIP_WHERE_SANITIZED();
    const std::string page = text_of(fs::path(THRONG_SOURCE_DIR) / "docs/architecture.md");
    const size_t begin = page.find("| folder |"), end = page.find("\n\n", begin);
    ASSERT_LT(end, page.size());
    const std::string table = page.substr(begin, end - begin);
    for (const auto& [folder, included] : folders_included())
        EXPECT_TRUE(table.find('`' + folder + '`') != std::string::npos ||
                    table.find("`src/" + folder + '`') != std::string::npos)
            << folder;
}

// Without this check a missing folder shows only as linker errors about functions.
TEST(Folders, ArePartsOfTheBuild) {
    THRONG_SKIP_WHERE_SANITIZED();
    const std::string build = text_of(fs::path(THRONG_SOURCE_DIR) / "CMakeLists.txt");
    const std::regex list(R"(throng_part\([^)]*?FOLDERS([ \w/\n]*?)(SOURCES|DEPENDS|EXCEPT|\)))");
    std::set<std::string> built;
    for (std::sregex_iterator found(build.begin(), build.end(), list), end; found != end; ++found) {
        const std::string folders = (*found)[1];
        const std::regex word(R"([\w/]+)");
        for (std::sregex_iterator name(folders.begin(), folders.end(), word); name != end; ++name)
            built.insert(name->str());
    }
    ASSERT_TRUE(built.contains("compile/mesh"));
    for (const fs::directory_entry& entry : fs::recursive_directory_iterator(kSources)) {
        const fs::path type = entry.path().extension(), file = entry.path().lexically_relative(kSources);
        const bool is_listed_elsewhere = file.parent_path() == "scan/methods" ||
                                         file.stem().string().ends_with("_reference");
        if ((type != ".cpp" && type != ".comp") || is_listed_elsewhere) continue;
        EXPECT_TRUE(built.contains(file.parent_path().string())) << file;
    }
}

}  // namespace
}  // namespace throng
