#include "tools/cli/command.h"

#include "base/replace_file.h"
#include "base/text.h"
#include "json/known_names.h"
#include "tools/cli/kept_characters.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <iostream>
#include <unistd.h>

namespace throng::tools {

std::optional<uint32_t> parse_number(std::string_view text) {
    uint32_t number = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
    return error == std::errc{} && end == text.data() + text.size() ? std::optional(number) : std::nullopt;
}

std::optional<std::pair<uint32_t, uint32_t>> parse_pair(std::string_view text, char between) {
    const size_t at = std::min(text.find(between), text.size());
    const auto first = parse_number(text.substr(0, at)),
               second = parse_number(text.substr(std::min(at + 1, text.size())));
    return first && second ? std::optional(std::pair(*first, *second)) : std::nullopt;
}

RendererSettings parse_size(const std::string& text) {
    const auto size = parse_pair(text, 'x');
    if (!size || size->first == 0 || size->second == 0)
        throw UsageError("--size " + text + ": give it as WIDTHxHEIGHT, for example 1920x1080");
    return {.width = size->first, .height = size->second};
}

void check_png_name(const char* option, const std::string& out) {
    if (!out.ends_with(".png"))
        throw UsageError(std::string(option) + " " + out + ": pictures are .png files; give a name that ends in .png");
}

Device open_device(const std::string& select) { return unwrap(Device::create({.select = select})); }

Device open_vulkan_device(const std::string& select) {
    const Device device = open_device(select);
    if (device.info().type == "native")
        throw CommandError("this command measures a Vulkan device, and " + device.info().name +
                           " is not one; 'throng bench cpu' measures the processor");
    return device;
}

std::string keys_text(const Character& character) {
    if (!character.packed) return "exact";
    std::array<char, 32> percent;
    std::snprintf(percent.data(), percent.size(), "%.2g %%", ClipTotals(character).error * 100);
    return percent.data();
}

std::vector<Character> load_characters(const std::vector<std::string>& files, const CompileSettings& settings,
                                       const LoadHooks& hooks) {
    std::vector<Character> characters;
    LoadHooks of_each = hooks;
    if (hooks.progress)
        of_each.progress = [&](double part_done) {
            hooks.progress((static_cast<double>(characters.size()) + part_done) / static_cast<double>(files.size()));
        };
    for (const std::string& file : files) {
        if (!hooks.progress) print_progress("reading " + file);
        characters.push_back(unwrap(load_kept_character(file, settings, of_each)));
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

double ClipTotals::ratio() const {
    return size_bytes == 0 ? 1 : static_cast<double>(raw_size_bytes) / static_cast<double>(size_bytes);
}

uint32_t find_clip(const Character& character, const std::string& name_or_index) {
    const uint32_t named = character.find_clip(name_or_index);
    if (named != kNone) return named;
    if (const auto index = parse_number(name_or_index); index && *index < character.clips.size()) return *index;

    KnownNames known("clip");
    std::vector<std::string> names;
    for (const Clip& clip : character.clips)
        names.push_back(clip.name.empty() ? std::to_string(names.size()) : clip.name);
    for (const std::string& name : names) known.add(name);
    throw CommandError(character.name + ": " + known.unknown(name_or_index));
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

void write_file(const std::filesystem::path& path, std::span<const std::byte> bytes) {
    try {
        replace_file(path, bytes);
    } catch (const Failure& failure) {
        throw CommandError(failure.what());
    }
}

}  // namespace throng::tools
