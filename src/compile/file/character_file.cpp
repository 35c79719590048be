#include "compile/file/character_file.h"

#include "base/replace_file.h"
#include "compile/file/character_layout.h"

#include <cstring>
#include <fstream>

namespace throng {
namespace fs = std::filesystem;

bool is_compiled_file(const fs::path& path) {
    std::error_code error;
    // Reading from a pipe would consume its data, or wait for ever
    if (!fs::is_regular_file(path, error)) return false;
    std::array<char, file::kMagic.size()> magic{};
    std::ifstream(path, std::ios::binary).read(magic.data(), magic.size());
    return magic == file::kMagic;
}

bool is_compiled_file(std::span<const std::byte> bytes) {
    return bytes.size() >= file::kMagic.size() &&
           std::memcmp(bytes.data(), file::kMagic.data(), file::kMagic.size()) == 0;
}

Result<void> save_character(const Character& character, const fs::path& path) {
    return as_result([&] { replace_file(path, write_character(character)); }, path.string());
}

Result<std::vector<std::byte>> save_character(const Character& character) {
    return as_result([&] { return write_character(character); }, character.name);
}

Result<Character> load_compiled_character(std::span<const std::byte> bytes, std::string_view name) {
    const std::string place = printable(name, 120);
    return as_result([&] { return read_character(bytes, place); }, place);
}

}  // namespace throng
