#include "tools/cli/kept_characters.h"

#include "base/cache_folder.h"
#include "base/crc64.h"
#include "import/limits.h"
#include "tools/cli/side_files.h"

#include <algorithm>
#include <array>
#include <cinttypes>
#include <cstdio>
#include <dlfcn.h>
#include <fstream>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <sys/stat.h>
#include <vector>

namespace throng::tools {
namespace {

namespace fs = std::filesystem;

constexpr uint64_t kMaxKept_bytes = uint64_t{1} << 30;

class Key {
public:
    void add(std::string_view bytes) { crc_ = crc64(std::as_bytes(std::span(bytes)), crc_); }
    template <class T>
    void add_number(const T& number) {
        crc_ = crc64(std::as_bytes(std::span(&number, 1)), crc_);
    }
    uint64_t value() const { return crc_; }

private:
    uint64_t crc_ = 0;
};

// Adds the build of the library that compiles: another build has another size or time.
bool add_build(Key& key) {
    Result<Character> (*const compiles)(const Asset&, const CompileSettings&, const LoadHooks&) = &compile_character;
    Dl_info library{};
    struct stat file {};
    if (dladdr(reinterpret_cast<const void*>(compiles), &library) == 0 || ::stat(library.dli_fname, &file) != 0)
        return false;
    key.add_number(file.st_size);
    key.add_number(file.st_mtim.tv_sec);
    key.add_number(file.st_mtim.tv_nsec);
    return true;
}

// Adds the rest of the file.
void add_rest(Key& key, std::ifstream& stream) {
    std::string part(1 << 20, '\0');
    while (stream.read(part.data(), static_cast<std::streamsize>(part.size())), stream.gcount() > 0)
        key.add(std::string_view(part).substr(0, static_cast<size_t>(stream.gcount())));
}

// Whether a file's JSON may refer to side files. The name "uri" can also be spelt with escapes of its letters.
bool may_have_side_files(std::string_view json) {
    constexpr std::array<std::string_view, 4> kSigns{"\"uri\"", "\\u0075", "\\u0072", "\\u0069"};
    return std::ranges::any_of(kSigns, [&](std::string_view sign) { return json.find(sign) != json.npos; });
}

// Adds the side files that load_character() would open, and which of them it would not find. False if it would fail.
bool add_side_files(Key& key, const std::string& file) {
    std::vector<SideFile> side_files;
    if (!find_side_files(file, side_files)) return false;
    std::set<fs::path> added;
    for (const auto& [uri, path] : side_files) {
        key.add_number(path.has_value());
        if (!path || !added.insert(*path).second) continue;
        std::error_code error;
        const uint64_t size_bytes = fs::file_size(*path, error);
        if (error || size_bytes > gltf::kFileLimitBytes) return false;
        key.add_number(size_bytes);
        std::ifstream stream(*path, std::ios::binary);
        add_rest(key, stream);
    }
    return true;
}

// Adds the content of a .glb or .gltf file and of its side files. False if it is anything else.
bool add_file(Key& key, const std::string& file) {
    struct Head {
        char magic[4];
        uint32_t version, size_bytes, json_bytes, json_type;
    };
    static_assert(sizeof(Head) == 20);
    std::error_code error;
    if (!fs::is_regular_file(file, error)) return false;  // a pipe would block here; load_character() reports it
    const uint64_t size_bytes = fs::file_size(file, error);
    std::ifstream stream(file, std::ios::binary);
    Head head{};
    stream.read(reinterpret_cast<char*>(&head), sizeof head);
    const bool is_glb = stream && std::string_view(head.magic, 4) == "glTF";
    if (!is_glb && fs::path(file).extension() != ".gltf") return false;
    if (!is_glb) {
        stream.clear();
        stream.seekg(0);
    }
    const uint64_t json_bytes = is_glb ? head.json_bytes : size_bytes;
    if (error || json_bytes > std::min(gltf::kJsonLimitBytes, size_bytes)) return false;
    std::string json(json_bytes, '\0');
    stream.read(json.data(), static_cast<std::streamsize>(json_bytes));
    if (!stream) return false;
    if (is_glb) key.add_number(head);
    key.add(json);
    add_rest(key, stream);
    return !may_have_side_files(json) || add_side_files(key, file);
}

// Where the character is, or would be, kept; none if it cannot be kept.
std::optional<fs::path> kept_file(const std::string& file, const CompileSettings& settings) {
    const fs::path folder = cache_folder();
    Key key;
    if (folder.empty() || !add_build(key) || !add_file(key, file)) return std::nullopt;
    key.add(fs::path(file).filename().string());
    key.add_number(settings.error);
    key.add_number(settings.lods);
    key.add(settings.root_motion_joint);
    std::array<char, 32> name{};
    std::snprintf(name.data(), name.size(), "%016" PRIx64 ".throng", key.value());
    return folder / "characters" / name.data();
}

// Removes the characters that have been unused longest.
void remove_oldest(const fs::path& folder) {
    struct Kept {
        fs::file_time_type used;
        uint64_t size_bytes;
        fs::path path;
    };
    std::vector<Kept> all;
    std::error_code error;
    for (const fs::directory_entry& entry : fs::directory_iterator(folder, error)) {
        const Kept kept{entry.last_write_time(error), error ? 0 : entry.file_size(error), entry.path()};
        if (!error) all.push_back(kept);
    }
    std::ranges::sort(all, std::greater(), &Kept::used);
    uint64_t sum = 0;
    for (const Kept& kept : all)
        if ((sum += kept.size_bytes) > kMaxKept_bytes) fs::remove(kept.path, error);
}

}  // namespace

Result<Character> load_kept_character(const std::string& file, const CompileSettings& settings,
                                      const LoadHooks& hooks) {
    const std::optional<fs::path> kept = kept_file(file, settings);
    std::error_code unimportant;
    if (kept && fs::exists(*kept, unimportant)) {
        if (Result<Character> character = load_character(*kept, {}, hooks)) {
            fs::last_write_time(*kept, fs::file_time_type::clock::now(), unimportant);
            return character;
        }
    }
    Result<Character> character = load_character(file, settings, hooks);
    // A file that changed after its checksum was taken may have been compiled in its new form
    if (!character || !kept || kept_file(file, settings) != kept) return character;
    fs::create_directories(kept->parent_path(), unimportant);
    if (!unimportant && save_character(*character, *kept)) remove_oldest(kept->parent_path());
    return character;
}

}  // namespace throng::tools
