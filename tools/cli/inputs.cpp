#include "tools/cli/inputs.h"

#include "base/read_file.h"
#include "import/container.h"
#include "import/read_asset.h"
#include "import/uri.h"
#include "tools/cli/command.h"

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

// The files that a glTF file refers to; none for any other file. For a broken file, whatever can be found: the loader
// reports what is wrong.
std::vector<FileOnDisk> side_files(const std::string& file) {
    std::vector<FileOnDisk> found;
    const std::filesystem::path path = file, folder = path.has_parent_path() ? path.parent_path() : ".";
    const auto add_all = [&] {
        gltf::Warnings ignored(file);
        const std::vector<std::byte> bytes = read_file(path, gltf::kFileLimitBytes, file);
        gltf::Budget budget(bytes.size());
        const JsonText json = gltf::parse_json(gltf::open_container(bytes, ignored).json, budget);
        for (const char* list : {"buffers", "images"})
            for (const JsonView item : json.view().optional_array(list)) {
                if (!item.has("uri") || !item.find("uri")->is_string()) continue;
                const std::string uri = item.required_string("uri");
                if (gltf::is_data_uri(uri)) continue;
                const auto named = as_result([&] { return gltf::resolve_side_file(uri, folder, file); });
                if (!named) continue;  // later entries may be valid
                if (auto side_file = on_disk(*named, uri + " of " + file)) found.push_back(std::move(*side_file));
            }
    };
    (void)as_result(add_all);
    return found;
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
        std::ranges::for_each(side_files(input), check_input);
    }
}

}  // namespace throng::tools
