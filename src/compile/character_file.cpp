#include "compile/character_file.h"

#include "base/failure.h"
#include "compile/character_layout.h"
#include "import/json_view.h"

#include <cstring>
#include <fstream>
#include <unistd.h>

namespace throng {
namespace {

namespace fs = std::filesystem;

// A reader of `path` sees the old file or the new one, never half of it.
void replace_file(const fs::path& path, std::span<const std::byte> bytes) {
    std::error_code error;
    const fs::file_type type = fs::status(path, error).type();
    if (type != fs::file_type::not_found && type != fs::file_type::regular) throw Failure(ErrorCode::kFile, path.string(), "is there, and not a plain file");
    fs::path unfinished = path;
    unfinished += ".part" + std::to_string(getpid());
    std::ofstream file(unfinished, std::ios::binary | std::ios::trunc);
    if (!file) throw Failure(ErrorCode::kFile, path.string(), "cannot be written; is its folder there?");
    file.write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
    file.close();
    if (file) fs::rename(unfinished, path, error);
    if (file && !error) return;
    std::error_code ignored;
    fs::remove(unfinished, ignored);
    throw Failure(ErrorCode::kFile, path.string(), "cannot be written; has the disk room?");
}

}  // namespace

bool is_compiled_file(const fs::path& path) {
    std::error_code error;
    if (!fs::is_regular_file(path, error)) return false;  // reading from a pipe would take away from it, or wait for ever
    std::array<char, file::kMagic.size()> magic{};
    std::ifstream(path, std::ios::binary).read(magic.data(), magic.size());
    return magic == file::kMagic;
}

Result<void> save_character(const Character& character, const fs::path& path) {
    return as_result([&] { replace_file(path, write_character(character)); }, path.string());
}

Result<Character> load_compiled_character(std::span<const std::byte> bytes, std::string_view name) {
    const std::string place = gltf::printable(name, 120);
    return as_result([&] { return read_character(bytes, place); }, place);
}

}  // namespace throng
