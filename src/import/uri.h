// URIs of buffers and images: data: and files beside the glTF file. Nothing else is ever opened.
#pragma once

#include "import/limits.h"

#include <cstddef>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace throng::gltf {

bool is_data_uri(std::string_view uri);

// The bytes of a data: URI, base64 or percent-encoded; missing padding is tolerated. Fails with kInvalidFile at
// `place`.
std::vector<std::byte> decode_data_uri(std::string_view uri, Budget& budget, const std::string& place);

// The path that a relative URI names: percent-decoded, with `/` in place of `\`, and without `.` and `..`, except for
// `..` at its beginning that lead out of the folder. Fails with kInvalidFile at `place` if the URI is no relative path.
std::string side_file_name(std::string_view uri, const std::string& place);

// The regular file of that name, in `folder` or below it, with links resolved. A file whose name contains the `\`
// itself comes first. Fails as side_file_name() does, also with kInvalidFile if the path or a link leads out of the
// folder, and with kFile if there is no such file.
std::filesystem::path resolve_side_file(std::string_view uri, const std::filesystem::path& folder,
                                        const std::string& place);

}  // namespace throng::gltf
