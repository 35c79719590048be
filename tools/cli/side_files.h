// The files that a glTF file refers to.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace throng::tools {

struct SideFile {
    std::string uri;
    std::optional<std::filesystem::path> path;  // where load_asset() finds it; none if it does not
};

// Appends those of a file; none for any other file. False if the file is broken: then whatever can be found is there.
bool find_side_files(const std::string& file, std::vector<SideFile>& found);

}  // namespace throng::tools
