// What the subcommands share: errors, common options, output.
#pragma once

#include "tools/stages.h"

#include <throng/throng.h>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

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

template <class T>
T unwrap(Result<T> result) {
    if (!result) throw CommandError(result.error().text());
    if constexpr (!std::is_void_v<T>) return std::move(*result);
}

// The whole text as a number.
std::optional<uint32_t> parse_number(std::string_view text);

// For options in seconds: "nan" and "inf" would be taken for numbers otherwise.
CLI::Validator finite();

// --device, for every command that uses one.
void add_device_option(CLI::App& app, std::string& select);
Device open_device(const std::string& select);

// A name of scan_methods(), with invocations a character or without, or one of `others`.
CLI::Validator scan_name(const std::vector<std::string>& others);

// --scan
void add_scan_option(CLI::App& app, std::string& scan);

// --path; the value that `path` has is the default.
void add_path_option(CLI::App& app, UpdatePath& path);

// --error: PERCENT of the character's size, or 'exact'. Refused with a compiled file, which has its own.
void add_error_option(CLI::App& app, CompileSettings& settings);

// --root-motion: JOINT. Added beside --error, and refused as that is.
void add_root_motion_option(CLI::App& app, CompileSettings& settings);

std::vector<Character> load_characters(const std::vector<std::string>& files, const CompileSettings& settings);

// How far a clip with root motion moves its character in one cycle. Needs rows.
struct Cycle {
    Cycle(const Character& character, const Clip& clip);

    double x, z;  // units of the file: metres
    double turn_degrees;  // about +y, -180 to 180
};

// Of all clips.
struct ClipTotals {
    explicit ClipTotals(const Character& character);

    double ratio() const;  // raw to compressed

    uint64_t size_bytes = 0, raw_size_bytes = 0;
    double error = 0;  // largest
};

// "exact", or the largest error that compression made in a clip, in percent of the size.
std::string keys_text(const Character& character);

// The clip with this name, or else with this number. Throws where there is none, naming those there are.
uint32_t find_clip(const Character& character, const std::string& name_or_index);

// Prints warnings to stderr, a line each.
void print_warnings(const std::vector<std::string>& warnings);

// One line that is rewritten, where stderr is a terminal; nothing otherwise.
void print_progress(const std::string& text);

void print_json(const nlohmann::json& json);

// For files to write. Said before the work is done: the folder must be there and writable, and what stands there already a plain file.
CLI::Validator writable_file();

// -o and --out, required.
void add_out_option(CLI::App& app, std::string& out, const std::string& description);

// As replace_file(), with a CommandError.
void write_file(const std::filesystem::path& path, std::span<const std::byte> bytes);

// Each adds one subcommand, which runs when it is parsed.
void add_info(CLI::App& app);
void add_compile(CLI::App& app);
void add_controller(CLI::App& app);
void add_pose(CLI::App& app);
void add_render(CLI::App& app);
void add_view(CLI::App& app);
void add_generate(CLI::App& app);
void add_bench(CLI::App& app);
void add_bench_frame(CLI::App& bench);
void add_bench_control(CLI::App& bench);
void add_bench_view(CLI::App& bench);
void add_bench_scan(CLI::App& bench);
void add_bench_baselines(CLI::App& bench);
void add_bench_report(CLI::App& bench);
void add_bench_diagrams(CLI::App& bench);
void add_tune(CLI::App& app);
void add_devices(CLI::App& app);

}  // namespace throng::tools
