// Films from pictures, by ffmpeg.
#pragma once

#include <cstdint>
#include <filesystem>

namespace throng::tools {

// Throws CommandError if ffmpeg is not installed.
void check_ffmpeg();

struct FilmPictures {
    std::filesystem::path folder;  // of pictures 000000.png and so on
    uint32_t first = 0, count = 0;
    double fps = 30;
};

// Writes H.264 as .mp4, in the colours of HD television, under a temporary name, and then renames it to `out`. The same
// pictures give the same bytes with the same ffmpeg. On failure throws CommandError with ffmpeg's reason, and leaves
// nothing behind.
void encode_film(const FilmPictures& pictures, const std::filesystem::path& out);

}  // namespace throng::tools
