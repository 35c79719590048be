#include "bench/report/gnuplot.h"

#include "base/failure.h"

#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <charconv>
#include <cstdio>
#include <cstring>
#include <memory>

namespace throng::bench {
namespace {

struct CloseFile {
    void operator()(std::FILE* file) const { std::fclose(file); }
};
using File = std::unique_ptr<std::FILE, CloseFile>;

// Files without a name stand at the child's three streams: unlike pipes they are never full, so neither side waits for the other.
File temporary_file() {
    File file(std::tmpfile());
    if (!file) throw Failure(ErrorCode::kFile, "gnuplot", std::string("no temporary file: ") + std::strerror(errno));
    return file;
}

std::string content(std::FILE* file) {
    std::string all;
    std::array<char, 65536> block;
    std::rewind(file);
    while (const size_t size = std::fread(block.data(), 1, block.size(), file)) all.append(block.data(), size);
    return all;
}

// gnuplot repeats the line of the script before it says what is wrong with it.
std::string first_complaint(const std::string& errors) {
    const size_t start = errors.find("line ");
    const std::string complaint = errors.substr(start == std::string::npos ? 0 : start);
    return complaint.substr(0, complaint.find('\n'));
}

}  // namespace

std::string run_gnuplot(const std::string& script) {
    const File in = temporary_file(), out = temporary_file(), errors = temporary_file();
    std::fwrite(script.data(), 1, script.size(), in.get());
    std::rewind(in.get());  // flushes, and the child starts where the file stands

    posix_spawn_file_actions_t files;
    posix_spawn_file_actions_init(&files);
    const std::array streams{in.get(), out.get(), errors.get()};
    for (size_t stream = 0; stream < streams.size(); ++stream) posix_spawn_file_actions_adddup2(&files, fileno(streams[stream]), static_cast<int>(stream));
    std::string program = "gnuplot", defaults = "--default-settings";
    char* words[]{program.data(), defaults.data(), nullptr};
    pid_t child = 0;
    const int spawned = posix_spawnp(&child, program.c_str(), &files, nullptr, words, environ);
    posix_spawn_file_actions_destroy(&files);

    int status = 0;
    if (spawned == 0)
        while (waitpid(child, &status, 0) < 0 && errno == EINTR) continue;
    const bool missing = spawned == ENOENT || (WIFEXITED(status) && WEXITSTATUS(status) == 127);
    if (missing) throw Failure(ErrorCode::kUnsupported, "gnuplot", "not installed, and the plots need it (Debian: apt-get install gnuplot-nox)");
    if (spawned != 0) throw Failure(ErrorCode::kUnsupported, "gnuplot", std::string("cannot be started: ") + std::strerror(spawned));
    if (status != 0) throw Failure(ErrorCode::kInvalidArgument, "gnuplot", first_complaint(content(errors.get())));
    return content(out.get());
}

std::string gnuplot_text(const std::string& text) {
    std::string quoted = "\"";
    for (const char c : text) {
        if (static_cast<unsigned char>(c) < ' ') quoted += ' ';
        else if (c == '`' || c == '"') quoted += '\'';
        else if (c == '\\') quoted += "\\\\";
        else quoted += c;
    }
    return quoted + '"';
}

std::string gnuplot_number(double value) {
    std::array<char, 32> digits;
    return {digits.data(), std::to_chars(digits.data(), digits.data() + digits.size(), value).ptr};
}

}  // namespace throng::bench
