#include "tools/film/encode.h"

#include "base/replace_file.h"
#include "tools/cli/child_program.h"
#include "tools/cli/command.h"

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <sys/wait.h>
#include <unistd.h>

namespace throng::tools {
namespace {

// Threads of the encoder. Fixed, because its output depends on their number, and by default it uses one per core
constexpr const char* kThreads = "8";

// Throws with the last line of ffmpeg's errors.
void run_ffmpeg(std::vector<std::string> arguments, const std::string& place) {
    using Start = ChildOutput::Start;
    arguments.insert(arguments.begin(), {"ffmpeg", "-nostdin", "-hide_banner", "-loglevel", "error", "-xerror"});
    const ChildOutput child = run_child_program(arguments, "");
    if (child.start == Start::kMissing)
        throw CommandError(
            "ffmpeg: is not installed, and is needed to make the .mp4 (Debian: apt-get install ffmpeg); pictures such "
            "as frame_%04d.png can be written without it");
    if (child.start == Start::kRefused) throw CommandError("ffmpeg: cannot be started: " + child.errors);
    if (child.status == 0) return;
    if (WIFSIGNALED(child.status))
        throw CommandError(place + ": ffmpeg was killed by signal " + std::to_string(WTERMSIG(child.status)));
    const std::string errors = child.errors.substr(0, child.errors.find_last_not_of('\n') + 1);
    throw CommandError(place +
                       ": ffmpeg: " + (errors.empty() ? "failed" : errors.substr(errors.find_last_of('\n') + 1)));
}

// Escapes %, which begins a number in ffmpeg's name patterns.
std::string without_numbers(const std::string& path) {
    std::string out;
    for (const char c : path) out += c == '%' ? "%%" : std::string(1, c);
    return out;
}

}  // namespace

void check_ffmpeg() { run_ffmpeg({"-version"}, "ffmpeg"); }

void encode_film(const FilmPictures& pictures, const std::filesystem::path& out) {
    namespace fs = std::filesystem;
    const fs::path absolute = fs::absolute(out);
    fs::path unfinished;
    // Creates the file first, because ffmpeg would follow a symbolic link of that name
    const int file = open_beside(absolute, unfinished);
    if (file < 0) throw CommandError(out.string() + ": cannot be written: " + std::strerror(errno));
    ::close(file);
    char rate[32];
    std::snprintf(rate, sizeof(rate), "%.10g", pictures.fps);
    std::error_code ignored;
    try {
        run_ffmpeg({"-y",
                    "-framerate",
                    rate,
                    "-start_number",
                    std::to_string(pictures.first),
                    "-i",
                    without_numbers(fs::absolute(pictures.folder).string()) + "/%06d.png",
                    "-frames:v",
                    std::to_string(pictures.count),
                    "-vf",
                    "scale=out_color_matrix=bt709:out_range=tv,format=yuv420p",
                    "-colorspace",
                    "bt709",
                    "-color_primaries",
                    "bt709",
                    "-color_trc",
                    "bt709",
                    "-c:v",
                    "libx264",
                    "-crf",
                    "18",
                    "-threads",
                    kThreads,
                    "-fflags",
                    "+bitexact",
                    "-flags:v",
                    "+bitexact",
                    "-map_metadata",
                    "-1",
                    "-movflags",
                    "+faststart",
                    "-f",
                    "mp4",
                    unfinished.string()},
                   out.string());
    } catch (...) {
        fs::remove(unfinished, ignored);
        throw;
    }
    std::error_code error;
    fs::rename(unfinished, absolute, error);
    if (!error) return;
    fs::remove(unfinished, ignored);
    throw CommandError(out.string() + ": cannot be written: " + error.message());
}

}  // namespace throng::tools
