// The frames of a film as files: which there are, which of them are whole, and what they were made with.
#pragma once

#include <nlohmann/json_fwd.hpp>

#include <cstdint>
#include <filesystem>
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

// Frames i with i % count == index, so that shards share what is slow in a film evenly.
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
    // Beside the frames: their settings.
    std::filesystem::path settings_path() const;

    // Throws CommandError where there are other settings, or frames without any. Only what `settings` has is compared.
    void check_settings(const nlohmann::json& settings) const;
    // The same, and writes them where there are none. Of shards that do so at once, one writes, and all compare.
    void keep_settings(const nlohmann::json& settings) const;
    // Those of the range and shard that are not there as whole pictures of this size.
    std::vector<uint32_t> missing(const FrameRange& range, const Shard& shard, uint32_t width, uint32_t height) const;

private:
    // One that is there, of any number, or none.
    std::filesystem::path some_frame() const;

    std::filesystem::path folder_;
    std::string before_, after_;  // the number, in the name
    size_t digits_ = 0;
};

}  // namespace throng::tools
