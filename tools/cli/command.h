// What the subcommands share: errors, characters, output.
#pragma once

#include <throng/throng.h>

#include <nlohmann/json_fwd.hpp>

#include <array>
#include <filesystem>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

namespace throng::tools {

// One line for stderr; main() prints it and exits with 1.
struct CommandError : std::runtime_error {
    using std::runtime_error::runtime_error;
};

// An option is wrong. Like CommandError, with a hint at the command's help, and exit code 2.
struct UsageError : std::runtime_error {
    using std::runtime_error::runtime_error;
};

template <class T>
T unwrap(Result<T> result) {
    if (!result) throw CommandError(result.error().text());
    if constexpr (!std::is_void_v<T>) return std::move(*result);
}

// The whole text as a number.
std::optional<uint32_t> parse_number(std::string_view text);

// Two numbers with something between them: "1920x1080".
std::optional<std::pair<uint32_t, uint32_t>> parse_pair(std::string_view text, char between);

// What --size says: WIDTHxHEIGHT. Throws UsageError.
RendererSettings parse_size(const std::string& text);

// Throws UsageError if a picture's name does not end in .png.
void check_png_name(const char* option, const std::string& out);

Device open_device(const std::string& select);
// A Vulkan device, for commands that measure its kernels.
Device open_vulkan_device(const std::string& select);

// Prints the progress of all files together, unless `hooks` receives it.
std::vector<Character> load_characters(const std::vector<std::string>& files, const CompileSettings& settings,
                                       const LoadHooks& hooks = {});

// How far a clip with root motion moves its character in one cycle. The clip must have root rows.
struct Cycle {
    Cycle(const Character& character, const Clip& clip);

    double x, z;          // units of the file: metres
    double turn_degrees;  // about +y, -180 to 180
};

// Sums over all clips.
struct ClipTotals {
    explicit ClipTotals(const Character& character);

    double ratio() const;  // raw to compressed

    uint64_t size_bytes = 0, raw_size_bytes = 0;
    double error = 0;  // largest
};

// "exact", or the largest error that compression made in a clip, in percent of the size.
std::string keys_text(const Character& character);

// The clip with this name, or else with this number. Throws if there is none, naming those there are.
uint32_t find_clip(const Character& character, const std::string& name_or_index);

// Prints warnings to stderr, a line each.
void print_warnings(const std::vector<std::string>& warnings);

// Rewrites one line of stderr if that is a terminal; otherwise prints nothing.
void print_progress(const std::string& text);

void print_json(const nlohmann::json& json);

// Like replace_file(), but throws a CommandError.
void write_file(const std::filesystem::path& path, std::span<const std::byte> bytes);

}  // namespace throng::tools
