#include "tools/command.h"

#include "base/replace_file.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <iostream>
#include <map>
#include <unistd.h>

namespace throng::tools {

std::optional<uint32_t> parse_number(std::string_view text) {
    uint32_t number = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
    return error == std::errc{} && end == text.data() + text.size() ? std::optional(number) : std::nullopt;
}

CLI::Validator finite() {
    return {[](std::string& text) { return std::isfinite(std::strtof(text.c_str(), nullptr)) ? "" : text + " is not a finite number"; }, ""};
}

void add_device_option(CLI::App& app, std::string& select) {
    app.add_option("--device", select, "a device's number, 'cpu', or a part of its name (default: a hardware GPU if there is one)");
}

Device open_device(const std::string& select) { return unwrap(Device::create({.select = select})); }

CLI::Validator scan_name(const std::vector<std::string>& others) {
    std::vector<std::string> names = others;
    for (const ScanMethodInfo& method : scan_methods()) names.push_back(method.name);
    std::string list;
    for (const std::string& name : names) list += (list.empty() ? "" : ", ") + name;
    return CLI::Validator(
        [names, list](const std::string& text) {
            const bool known = std::find(names.begin(), names.end(), text.substr(0, text.find(':'))) != names.end();
            return known ? std::string() : "'" + text + "' is no scan method; the methods are: " + list;
        },
        "METHOD[:LANES]:{" + list + "}");
}

void add_path_option(CLI::App& app, UpdatePath& path) {
    static const std::map<std::string, UpdatePath> names{{"auto", UpdatePath::kAuto}, {"fused", UpdatePath::kFused}, {"staged", UpdatePath::kStaged}};
    app.add_option("--path", path, "fused: sample, blend, scan and bind in one pass; staged: one after another; auto: fused where it applies")
        ->transform(CLI::CheckedTransformer(names))
        ->default_str(std::find_if(names.begin(), names.end(), [&](const auto& name) { return name.second == path; })->first);
}

void add_scan_option(CLI::App& app, std::string& scan) {
    app.add_option("--scan", scan, "method of the Hierarchy-Scan, and its invocations a character")->check(scan_name({"auto"}))->capture_default_str();
}

void add_error_option(CLI::App& app, CompileSettings& settings) {
    constexpr double kLeast_percent = 1e-4, kMost_percent = 10;
    const auto check = [](const std::string& text) -> std::string {
        char* end = nullptr;
        const double percent = std::strtod(text.c_str(), &end);
        const bool is_number = end != text.c_str() && *end == '\0';
        if (text == "exact" || (is_number && percent >= kLeast_percent && percent <= kMost_percent)) return {};
        return "'" + text + "' is neither 'exact' nor a percentage from 0.0001 to 10";
    };
    const auto set = [&settings](const std::string& text) { settings.error = text == "exact" ? 0 : std::strtod(text.c_str(), nullptr) / 100; };
    char by_default[16] = "exact";
    if (settings.error > 0) std::snprintf(by_default, sizeof(by_default), "%g", settings.error * 100);
    app.add_option_function<std::string>("--error", set, "how far compressed clips may displace the skin, in percent of the character's size; 'exact': not compressed")
        ->check(CLI::Validator(check, "PERCENT|exact"))
        ->default_str(by_default);
    app.parse_complete_callback([&app] {
        const auto refuse_compiled = [&](const char* name, const std::string& what) {
            const CLI::Option* option = app.get_option_no_throw(name);
            if (!option || option->count() == 0) return;
            for (const CLI::Option* files : app.get_options([](const CLI::Option* of) { return of->get_positional(); }))
                for (const std::string& file : files->results())
                    if (is_compiled_file(file)) throw CommandError(file + " is compiled already, " + what + ": leave " + name + " out, or give its source");
        };
        refuse_compiled("--error", "within an error of its own");
        refuse_compiled("--root-motion", "with its own root motion or none");
    });
}

void add_root_motion_option(CLI::App& app, CompileSettings& settings) {
    app.add_option("--root-motion", settings.root_motion_joint, "a joint whose way over the ground is taken out of the clips, for characters with a controller to move by")->type_name("JOINT");
}

std::string keys_text(const Character& character) {
    if (!character.packed) return "exact";
    std::array<char, 32> percent;
    std::snprintf(percent.data(), percent.size(), "%.2g %%", ClipTotals(character).error * 100);
    return percent.data();
}

std::vector<Character> load_characters(const std::vector<std::string>& files, const CompileSettings& settings) {
    std::vector<Character> characters;
    for (const std::string& file : files) {
        print_progress("reading " + file);
        characters.push_back(unwrap(load_character(file, settings)));
        print_warnings(characters.back().warnings);
    }
    print_progress("");
    return characters;
}

Cycle::Cycle(const Character& character, const Clip& clip) {
    const auto& last = character.root_rows[clip.first_root_row + clip.root_row_count - 1];
    x = last[0];
    z = last[1];
    turn_degrees = std::atan2(last[3], last[2]) * 180 / 3.14159265358979323846;
}

ClipTotals::ClipTotals(const Character& character) {
    for (const Clip& clip : character.clips) {
        size_bytes += clip.size_bytes;
        raw_size_bytes += clip.raw_size_bytes;
        error = std::max(error, clip.error);
    }
}

double ClipTotals::ratio() const { return size_bytes == 0 ? 1 : static_cast<double>(raw_size_bytes) / static_cast<double>(size_bytes); }

uint32_t find_clip(const Character& character, const std::string& name_or_index) {
    const uint32_t named = character.find_clip(name_or_index);
    if (named != kNone) return named;
    if (const auto index = parse_number(name_or_index); index && *index < character.clips.size()) return *index;

    constexpr size_t kShown = 20;
    std::string names;
    for (size_t i = 0; i < std::min(character.clips.size(), kShown); ++i) names += (i ? ", " : "") + std::to_string(i) + " '" + character.clips[i].name + "'";
    if (character.clips.size() > kShown) names += ", …";
    throw CommandError(character.name + ": no clip '" + name_or_index + "'; " + (names.empty() ? "the file has none" : "there are: " + names));
}

void print_warnings(const std::vector<std::string>& warnings) {
    print_progress("");
    for (const std::string& warning : warnings) std::cerr << "throng: warning: " << warning << "\n";
}

void print_progress(const std::string& text) {
    if (isatty(STDERR_FILENO)) std::cerr << "\r\033[K" << text << std::flush;
}

void print_json(const nlohmann::json& json) {
    std::cout << json.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace) << "\n";
}

CLI::Validator writable_file() {
    const auto check = [](std::string& text) -> std::string {
        const std::filesystem::path path = text, folder = path.has_parent_path() ? path.parent_path() : ".";
        std::error_code error;
        const auto type = std::filesystem::status(path, error).type();
        if (access(folder.c_str(), W_OK) != 0) return text + " cannot be written: is its folder there?";
        if (type == std::filesystem::file_type::not_found || type == std::filesystem::file_type::regular) return {};
        return text + " is there, and not a plain file";
    };
    return {check, ""};
}

void add_out_option(CLI::App& app, std::string& out, const std::string& description) {
    app.add_option("-o,--out", out, description)->required()->check(writable_file());
}

void write_file(const std::filesystem::path& path, std::span<const std::byte> bytes) {
    try {
        replace_file(path, bytes);
    } catch (const Failure& failure) {
        throw CommandError(failure.what());
    }
}

}  // namespace throng::tools
