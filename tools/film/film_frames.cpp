#include "tools/film/film_frames.h"

#include "base/failure.h"
#include "base/read_file.h"
#include "base/replace_file.h"
#include "base/thread_pool.h"
#include "tools/cli/command.h"

#include <nlohmann/json.hpp>

#define STB_IMAGE_STATIC
#define STB_IMAGE_IMPLEMENTATION
#define STBI_ONLY_PNG
#define STBI_NO_STDIO
#include <stb/stb_image.h>

#include <algorithm>
#include <limits>
#include <memory>

namespace throng::tools {
namespace {

constexpr uint32_t kMaxFrames = 1'000'000;
constexpr uint64_t kDecoding_bytes = uint64_t{1} << 30;

Result<std::vector<std::byte>> content(const std::filesystem::path& path) {
    return as_result([&] { return read_file(path, std::numeric_limits<int>::max(), path.string()); });
}

bool is_whole(const std::filesystem::path& path, uint32_t width, uint32_t height) {
    const auto bytes = content(path);
    if (!bytes) return false;
    int picture_width = 0, picture_height = 0, channels = 0;
    const std::unique_ptr<stbi_uc, decltype(&stbi_image_free)> pixels(
        stbi_load_from_memory(reinterpret_cast<const stbi_uc*>(bytes->data()), static_cast<int>(bytes->size()),
                              &picture_width, &picture_height, &channels, 4),
        stbi_image_free);
    return pixels && static_cast<uint32_t>(picture_width) == width && static_cast<uint32_t>(picture_height) == height;
}

}  // namespace

FrameRange parse_frames(const std::string& text) {
    const auto range = parse_pair(text, ':');
    if (!range || range->first >= range->second || range->second > kMaxFrames)
        throw UsageError(
            "--frames " + text +
            ": give it as FIRST:END with FIRST below END, for example 0:240 for frames 0 to 239; END is at most " +
            std::to_string(kMaxFrames));
    return {range->first, range->second};
}

Shard parse_shard(const std::string& text) {
    if (text.empty()) return {};
    const auto shard = parse_pair(text, '/');
    if (!shard || shard->first >= shard->second)
        throw UsageError("--shard " + text + ": give it as I/N with I from 0 to N - 1, for example 0/4 to 3/4");
    return {shard->first, shard->second};
}

FrameFiles::FrameFiles(const std::filesystem::path& pattern) : folder_(pattern.parent_path()) {
    const std::string name = pattern.filename().string();
    const size_t percent = name.find('%'), d = name.find('d', std::min(percent, name.size()));
    const auto wrong = [&] {
        return UsageError("--out " + pattern.string() +
                          ": with --frames, give a film.mp4, or numbered pictures such as frame_%04d.png");
    };
    if (percent == std::string::npos || d == std::string::npos || !name.ends_with(".png") ||
        name.find('%', percent + 1) != std::string::npos)
        throw wrong();
    const std::string digits = name.substr(percent + 1, d - percent - 1);
    if (!digits.empty()) {
        const auto number = parse_number(digits);
        if (digits[0] != '0' || !number || *number > 9) throw wrong();
        digits_ = *number;
    }
    before_ = name.substr(0, percent);
    after_ = name.substr(d + 1);
}

std::filesystem::path FrameFiles::path(uint32_t frame) const {
    const std::string number = std::to_string(frame);
    return folder_ / (before_ + std::string(digits_ - std::min(digits_, number.size()), '0') + number + after_);
}

std::filesystem::path FrameFiles::settings_path() const {
    return folder_ / (before_ + "settings" + after_.substr(0, after_.size() - 4) + ".json");
}

std::filesystem::path FrameFiles::some_frame() const {
    std::error_code error;
    for (const auto& entry : std::filesystem::directory_iterator(folder_.empty() ? "." : folder_, error)) {
        const std::string name = entry.path().filename().string();
        if (name.size() <= before_.size() + after_.size() || !name.starts_with(before_) || !name.ends_with(after_))
            continue;
        if (parse_number(std::string_view(name).substr(before_.size(), name.size() - before_.size() - after_.size())))
            return folder_ / name;
    }
    return {};
}

void FrameFiles::check_settings(const nlohmann::json& settings) const {
    const std::string place = settings_path().string(), advice = "; remove it and the frames, or give another --out";
    const auto bytes = content(settings_path());
    if (!bytes) {
        const std::filesystem::path frame = some_frame();
        if (frame.empty()) return;
        throw CommandError(frame.string() + " exists, but " + place +
                           ", which records its settings, does not; remove the frames, or give another --out");
    }
    const std::string_view text(reinterpret_cast<const char*>(bytes->data()), bytes->size());
    const nlohmann::json there = nlohmann::json::parse(text, nullptr, false);
    for (const auto& [name, value] : settings.items()) {
        const nlohmann::json found = there.is_object() && there.contains(name) ? there[name] : nlohmann::json();
        if (found != value)
            throw CommandError(place + ": the frames beside it were made with " + name + " " + found.dump() + ", not " +
                               value.dump() + advice);
    }
}

void FrameFiles::keep_settings(const nlohmann::json& settings) const {
    check_settings(settings);
    const std::string text = settings.dump(2) + "\n";
    unwrap(as_result([&] { create_file(settings_path(), std::as_bytes(std::span(text))); }));
    check_settings(settings);
}

std::vector<uint32_t> FrameFiles::missing(const FrameRange& range, const Shard& shard, uint32_t width, uint32_t height,
                                          const std::function<void(size_t checked, size_t all)>& report) const {
    std::vector<uint32_t> missing, there;
    std::error_code error;
    for (const uint32_t frame : range.frames())
        if (shard.has(frame)) (std::filesystem::exists(path(frame), error) ? there : missing).push_back(frame);
    if (there.empty()) return missing;
    ThreadPool threads(0);
    // Decoding a frame takes its pixels twice. One for which memory runs out would count as missing and be drawn again
    const uint64_t room_for = kDecoding_bytes / (8 * uint64_t{width} * height);
    const size_t at_once = std::clamp<uint64_t>(room_for, 1, threads.concurrency());
    std::vector<char> are_whole(there.size());
    for (size_t first = 0; first < there.size(); first += at_once) {
        report(first, there.size());
        const auto count = static_cast<uint32_t>(std::min(at_once, there.size() - first));
        for_each_job(threads, count,
                     [&](uint32_t i) { are_whole[first + i] = is_whole(path(there[first + i]), width, height); });
    }
    for (size_t i = 0; i < there.size(); ++i)
        if (!are_whole[i]) missing.push_back(there[i]);
    std::ranges::sort(missing);
    return missing;
}

}  // namespace throng::tools
