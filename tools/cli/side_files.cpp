#include "tools/cli/side_files.h"

#include "base/read_file.h"
#include "import/container.h"
#include "import/read_asset.h"
#include "import/uri.h"

namespace throng::tools {

bool find_side_files(const std::string& file, std::vector<SideFile>& found) {
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
                found.push_back({uri, named ? std::optional(*named) : std::nullopt});
            }
    };
    return static_cast<bool>(as_result(add_all));
}

}  // namespace throng::tools
