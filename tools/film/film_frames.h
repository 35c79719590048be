// The frames of a film as files: which exist, which of them are complete, and the settings they were made with.
#pragma once

#include <nlohmann/json_fwd.hpp>

#include <cstdint>
#include <filesystem>
#include <functional>
#include <ranges>
#include <string>
#include <vector>

namespace throng::tools {

// Frames first <= i < end.
struct FrameRange {
    uint32_t first = 0, end = 0;

    auto frames() const { return std::views::iota(first, end); }
};
// "A:B". Throws UsageError.
FrameRange parse_frames(const std::string& text);

// Frames i with i % count == index, so that shards share the slow parts of a film evenly.
struct Shard {
    uint32_t index = 0, count = 1;

    bool has(uint32_t frame) const { return frame % count == index; }
};
// "I/N"; empty: all. Throws UsageError.
Shard parse_shard(const std::string& text);

class FrameFiles {
public:
    // `pattern`: a path whose name has one %d or %04d, for the number, and ends in .png. Throws UsageError.
    explicit FrameFiles(const std::filesystem::path& pattern);

    std::filesystem::path path(uint32_t frame) const;
    // The file beside the frames that holds their settings.
    std::filesystem::path settings_path() const;

    // Throws CommandError if the settings file differs, or if there are frames but no settings file. Compares only the
    // fields that `settings` has.
    void check_settings(const nlohmann::json& settings) const;
    // The same, and writes the file if there is none. If several shards do this at once, one of them writes, and all
    // compare.
    void keep_settings(const nlohmann::json& settings) const;
    // The frames of the range and shard that do not yet exist as complete pictures of this size. Existing frames are
    // decoded to find out; meanwhile `report` is called repeatedly with how many of how many are done, and may throw.
    std::vector<uint32_t> missing(const FrameRange& range, const Shard& shard, uint32_t width, uint32_t height,
                                  const std::function<void(size_t checked, size_t all)>& report) const;

private:
    // An existing frame with any number; empty if there is none.
    std::filesystem::path some_frame() const;

    std::filesystem::path folder_;
    std::string before_, after_;  // the parts of the name around the number
    size_t digits_ = 0;
};

}  // namespace throng::tools
