#include "tools/cli/child_program.h"

#include "base/failure.h"

#include <spawn.h>
#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <memory>

namespace throng {
namespace {

struct CloseFile {
    void operator()(std::FILE* file) const { std::fclose(file); }
};
using File = std::unique_ptr<std::FILE, CloseFile>;

// The child's three streams are files in memory: unlike pipes they are never full, so neither side waits for the other,
// and unlike temporary files they need no room on a disk.
File memory_file(const std::string& program) {
    const int memory = memfd_create(program.c_str(), MFD_CLOEXEC);
    File file(memory < 0 ? nullptr : fdopen(memory, "w+"));
    if (!file)
        throw Failure(ErrorCode::kFile, program, std::string("cannot make a file in memory: ") + std::strerror(errno));
    return file;
}

std::string content(std::FILE* file) {
    std::string all;
    std::array<char, 65536> block;
    std::rewind(file);
    while (const size_t size = std::fread(block.data(), 1, block.size(), file)) all.append(block.data(), size);
    return all;
}

// Waits for the end of a child process.
int status_of(pid_t child, const std::string& program) {
    int status = 0;
    while (waitpid(child, &status, 0) < 0)
        if (errno != EINTR)
            throw Failure(ErrorCode::kFile, program,
                          std::string("cannot find out how it ended: ") + std::strerror(errno));
    return status;
}

}  // namespace

ChildOutput run_child_program(std::vector<std::string> name_and_arguments, const std::string& input) {
    const std::string& program = name_and_arguments.front();
    const File in = memory_file(program), out = memory_file(program), errors = memory_file(program);
    const bool is_written = std::fwrite(input.data(), 1, input.size(), in.get()) == input.size() &&
                            std::fflush(in.get()) == 0;
    if (!is_written)
        throw Failure(ErrorCode::kFile, program, std::string("cannot store its input: ") + std::strerror(errno));
    std::rewind(in.get());  // the child reads from the file's position

    posix_spawn_file_actions_t files;
    posix_spawn_file_actions_init(&files);
    const std::array streams{in.get(), out.get(), errors.get()};
    for (size_t stream = 0; stream < streams.size(); ++stream)
        posix_spawn_file_actions_adddup2(&files, fileno(streams[stream]), static_cast<int>(stream));
    std::vector<char*> words;
    for (std::string& word : name_and_arguments) words.push_back(word.data());
    words.push_back(nullptr);
    pid_t child = 0;
    const int spawned = posix_spawnp(&child, program.c_str(), &files, nullptr, words.data(), environ);
    posix_spawn_file_actions_destroy(&files);

    const int status = spawned == 0 ? status_of(child, program) : 0;
    if (spawned == ENOENT || (WIFEXITED(status) && WEXITSTATUS(status) == 127))
        return {.output = {}, .errors = {}, .status = -1, .start = ChildOutput::Start::kMissing};
    if (spawned != 0)
        return {.output = {}, .errors = std::strerror(spawned), .status = -1, .start = ChildOutput::Start::kRefused};
    return {.output = content(out.get()), .errors = content(errors.get()), .status = status};
}

}  // namespace throng
