#include "tools/cli/inputs.h"

#include "tools/cli/command.h"
#include "tools/cli/side_files.h"

#include <algorithm>
#include <sys/stat.h>

namespace throng::tools {
namespace {

struct FileOnDisk {
    dev_t device;
    ino_t number;
    std::string name;  // as a message gives it

    bool is(const FileOnDisk& other) const { return device == other.device && number == other.number; }
};

// Nothing where there is no file.
std::optional<FileOnDisk> on_disk(const std::filesystem::path& path, const std::string& name) {
    struct stat status {};
    if (::stat(path.c_str(), &status) != 0) return std::nullopt;
    return FileOnDisk{status.st_dev, status.st_ino, name};
}

}  // namespace

void protect_inputs(const std::vector<std::string>& inputs, const std::vector<std::filesystem::path>& outs) {
    std::vector<FileOnDisk> existing;
    for (const std::filesystem::path& out : outs)
        if (auto file = on_disk(out, out.string())) existing.push_back(std::move(*file));
    if (existing.empty()) return;
    const auto check_input = [&](const FileOnDisk& input) {
        const auto out = std::ranges::find_if(existing, [&](const FileOnDisk& file) { return file.is(input); });
        if (out == existing.end()) return;
        throw CommandError(out->name + ": would overwrite " + input.name +
                           ", which this command reads; give another name");
    };
    for (const std::string& input : inputs) {
        if (const auto file = on_disk(input, input)) check_input(*file);
        std::vector<SideFile> side_files;
        find_side_files(input, side_files);  // of a broken file, some: loading it reports what is wrong
        for (const auto& [uri, path] : side_files)
            if (const auto file = path ? on_disk(*path, uri + " of " + input) : std::nullopt) check_input(*file);
    }
}

}  // namespace throng::tools
