#include "tools/graphviz.h"

#include "tools/command.h"

#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <memory>

namespace throng::tools {
namespace {

struct CloseFile {
    void operator()(std::FILE* file) const { std::fclose(file); }
};
using File = std::unique_ptr<std::FILE, CloseFile>;

// Files without a name stand at the child's three streams: unlike pipes they are never full, so neither side waits for the other.
File temporary_file() {
    File file(std::tmpfile());
    if (!file) throw CommandError(std::string("dot: no temporary file: ") + std::strerror(errno));
    return file;
}

std::string content(std::FILE* file) {
    std::string all;
    std::array<char, 65536> block;
    std::rewind(file);
    while (const size_t size = std::fread(block.data(), 1, block.size(), file)) all.append(block.data(), size);
    return all;
}

}  // namespace

std::string run_graphviz(const std::string& graph) {
    const File in = temporary_file(), out = temporary_file(), errors = temporary_file();
    std::fwrite(graph.data(), 1, graph.size(), in.get());
    std::rewind(in.get());  // flushes, and the child starts where the file stands

    posix_spawn_file_actions_t files;
    posix_spawn_file_actions_init(&files);
    const std::array streams{in.get(), out.get(), errors.get()};
    for (size_t stream = 0; stream < streams.size(); ++stream) posix_spawn_file_actions_adddup2(&files, fileno(streams[stream]), static_cast<int>(stream));
    std::string program = "dot", format = "-Tsvg";
    char* words[]{program.data(), format.data(), nullptr};
    pid_t child = 0;
    const int spawned = posix_spawnp(&child, program.c_str(), &files, nullptr, words, environ);
    posix_spawn_file_actions_destroy(&files);

    int status = 0;
    if (spawned == 0)
        while (waitpid(child, &status, 0) < 0 && errno == EINTR) continue;
    const bool missing = spawned == ENOENT || (WIFEXITED(status) && WEXITSTATUS(status) == 127);
    if (missing) throw CommandError("dot: Graphviz is not installed, and draws the SVG (Debian: apt-get install graphviz); a .dot file needs none");
    if (spawned != 0) throw CommandError(std::string("dot: cannot be started: ") + std::strerror(spawned));
    const std::string complaint = content(errors.get());
    if (status != 0) throw CommandError("dot: " + complaint.substr(0, complaint.find('\n')));
    return content(out.get());
}

std::string graphviz_text(const std::string& text) {
    std::string quoted = "\"";
    for (const char c : text) {
        if (c == '"' || c == '\\') quoted += '\\';
        quoted += static_cast<unsigned char>(c) < ' ' ? ' ' : c;
    }
    return quoted + '"';
}

}  // namespace throng::tools
