#include "tests/tool_runner.h"

#include "tests/without_cache.h"

#include <nlohmann/json.hpp>

#include <cerrno>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <iterator>
#include <sstream>
#include <stdexcept>
#include <sys/resource.h>
#include <sys/wait.h>
#include <system_error>
#include <thread>
#include <unistd.h>

namespace throng::test {
namespace {

#if defined(__SANITIZE_ADDRESS__)
constexpr bool kAddressSanitizer = true;
#elif defined(__has_feature)
constexpr bool kAddressSanitizer = __has_feature(address_sanitizer);
#else
constexpr bool kAddressSanitizer = false;
#endif

// Does not move the file offset, since a process that is still running writes there.
std::string contents(std::FILE* file) {
    std::string text;
    char buffer[4096];
    for (ssize_t count; (count = pread(fileno(file), buffer, sizeof(buffer), static_cast<off_t>(text.size()))) > 0;)
        text.append(buffer, static_cast<size_t>(count));
    return text;
}

}  // namespace

Words::Words(const std::string& text) {
    std::istringstream words(text);
    assign(std::istream_iterator<std::string>(words), {});
}

Words operator+(Words words, const Words& more) {
    words.insert(words.end(), more.begin(), more.end());
    return words;
}

bool Outcome::refused(const std::string& named) const {
    return exit_code > 0 && err.starts_with("throng: ") && err.find('\n') == err.size() - 1 &&
           err.find(named) != std::string::npos;
}

std::ostream& operator<<(std::ostream& stream, const Outcome& outcome) {
    return stream << "exit code " << outcome.exit_code << ", signal " << outcome.signal << ", " << outcome.time_s
                  << " s\nstdout: " << outcome.out.substr(0, 2000) << "\nstderr: " << outcome.err.substr(0, 2000);
}

Outcome run_tool(const Words& arguments, const RunSettings& settings) {
    std::FILE *out = std::tmpfile(), *err = std::tmpfile();
    const char* program = settings.program ? settings.program : THRONG_TOOL;
    std::vector<const char*> words{program};
    for (const std::string& argument : arguments) words.push_back(argument.c_str());
    words.push_back(nullptr);
    const auto start = std::chrono::steady_clock::now();
    const pid_t child = fork();
    if (child == 0) {
        leave_cache_folder();
        for (const auto& [name, value] : settings.environment) setenv(name.c_str(), value.c_str(), 1);
        if (settings.out_path) out = std::fopen(settings.out_path, "w");
        dup2(fileno(out), STDOUT_FILENO);
        dup2(fileno(err), STDERR_FILENO);
        const rlimit no_core{0, 0}, memory{settings.memory_limit_bytes, settings.memory_limit_bytes};
        setrlimit(RLIMIT_CORE, &no_core);
        if (settings.memory_limit_bytes > 0 && !kAddressSanitizer) setrlimit(RLIMIT_AS, &memory);
        alarm(settings.time_limit_s);  // stays set across exec, and kills the process
        execvp(program, const_cast<char* const*>(words.data()));
        _exit(127);
    }
    int status = 0;
    for (pid_t ended = 0; ended != child; ended = waitpid(child, &status, settings.watch ? WNOHANG : 0)) {
        if (ended < 0 && errno != EINTR) throw std::system_error(errno, std::generic_category(), "waitpid");
        if (!settings.watch) continue;
        settings.watch(child, contents(err));
        std::this_thread::sleep_for(std::chrono::milliseconds(5));
    }
    Outcome run;
    run.time_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    if (WIFEXITED(status)) run.exit_code = WEXITSTATUS(status);
    if (WIFSIGNALED(status)) run.signal = WTERMSIG(status);
    run.out = contents(out);
    run.err = contents(err);
    std::fclose(out);
    std::fclose(err);
    return run;
}

void ToolTest::SetUpTestSuite() {
    folder_ = std::make_unique<TemporaryFolder>();
    std::filesystem::current_path(folder_->path());
}

void ToolTest::TearDownTestSuite() {
    std::filesystem::current_path("/");
    folder_.reset();
}

std::string ToolTest::file(const std::string& name) { return (folder_->path() / name).string(); }

std::string ToolTest::write(const std::string& name, const std::string& content) {
    return folder_->write(name, content).string();
}

std::set<std::filesystem::path> ToolTest::files() { return {std::filesystem::directory_iterator(folder_->path()), {}}; }

void ToolTest::generate(const std::string& name, const Words& arguments) {
    succeed(Words{"generate", "--out", file(name)} + arguments);
}

Outcome ToolTest::succeed(const Words& arguments, const RunSettings& settings) {
    Outcome run = run_tool(arguments, settings);
    if (run.succeeded()) return run;
    std::ostringstream said;
    said << testing::PrintToString(arguments) << "\n" << run;
    throw std::runtime_error(said.str());
}

Json ToolTest::json_of(const Words& arguments, const RunSettings& settings) {
    const Outcome run = succeed(arguments + "--json", settings);
    Json json = Json::parse(run.out, nullptr, false);
    EXPECT_FALSE(json.is_discarded()) << run;
    return json;
}

void ToolTest::expect_refused(const std::vector<Refused>& cases) {
    const std::set<std::filesystem::path> before = files();
    for (const auto& [arguments, named] : cases) {
        const Outcome run = run_tool(arguments, {.time_limit_s = 20});
        EXPECT_TRUE(run.refused(named)) << testing::PrintToString(arguments) << "\n" << run;
        EXPECT_EQ(run.out, "") << testing::PrintToString(arguments);
        EXPECT_LT(run.time_s, 10) << testing::PrintToString(arguments);
    }
    EXPECT_EQ(files(), before) << "something was left behind";
}

}  // namespace throng::test
