// How a command declares its options. Only options.cpp includes CLI11, which parses them: a file that includes it
// takes 5 s longer to compile.
#pragma once

#include <throng/character.h>
#include <throng/crowd.h>
#include <throng/draw.h>

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

namespace CLI {
class App;
class Option;
}  // namespace CLI

namespace throng::tools {

// A check of the text of an option, before it is taken.
struct Check {
    std::function<std::string(const std::string& text)> what_is_wrong;  // empty if the text is right
    std::string values{};                                               // what help calls them
};

// From `least` to `most`.
Check range(uint32_t least, uint32_t most);
Check range(double least, double most);
Check is_member(const std::vector<std::string>& names);
Check existing_folder();
// For options in seconds: otherwise "nan" and "inf" would pass as numbers.
Check finite();
// A name of scan_methods(), with or without invocations a character, or one of `others`.
Check scan_name(const std::vector<std::string>& others);
// For files to write, checked before the work is done: the folder must exist and be writable, and a file that exists
// already must be a plain file.
Check writable_file();

// An option of a command; each setter returns the option itself.
class Option {
public:
    explicit Option(CLI::Option* option) : option_(option) {}

    Option required();
    Option check(const Check& check);
    Option delimiter(char between);
    Option expected(int count);
    Option needs(Option other);
    Option excludes(Option other);
    // Hides it from help.
    Option hide();
    // The default that help shows: the value that its variable has now, or this text.
    Option capture_default_str();
    Option default_str(const std::string& text);

    bool empty() const;  // not given

private:
    CLI::Option* option_;
};

class Command {
public:
    explicit Command(CLI::App& app) : app_(&app) {}

    // If the subcommand is named, options given before its name are refused.
    Command add_subcommand(const std::string& name, const std::string& description);
    // One of its subcommands must be given; `names` is what a message calls them.
    void require_subcommand(const std::string& names);
    bool has_subcommand() const;  // was given

    // What an option may set.
    using Variable = std::variant<std::string*, uint32_t*, uint64_t*, float*, double*, std::optional<uint32_t>*,
                                  std::optional<uint64_t>*, std::vector<std::string>*, std::vector<uint32_t>*,
                                  std::vector<float>*, std::vector<double>*>;
    // A name without dashes makes it a positional argument. `value` must live until the command has run.
    template <class T>
    Option add_option(const std::string& names, T& value, const std::string& description) {
        return add_variable(names, &value, description);
    }
    Option add_flag(const std::string& names, bool& value, const std::string& description);
    // Takes one of the names, or its number.
    template <class Enum>
    Option add_choice(const std::string& names, Enum& value, const std::map<std::string, Enum>& choices,
                      const std::string& description) {
        std::map<std::string, int> numbers;
        std::string by_default;
        for (const auto& [name, choice] : choices) {
            numbers[name] = static_cast<int>(choice);
            if (choice == value) by_default = name;
        }
        const auto set = [&value](int number) { value = static_cast<Enum>(number); };
        return add_numbered(names, set, numbers, description).default_str(by_default);
    }
    void footer(const std::string& text);
    // What the command does once everything is parsed.
    void callback(std::function<void()> run);
    // The same, with options that live as long as the command.
    template <class Options>
    Options& options_of(void (*run)(const Options& options)) {
        const auto options = std::make_shared<Options>();
        callback([options, run] { run(*options); });
        return *options;
    }

    CLI::App& app() const { return *app_; }

private:
    Option add_variable(const std::string& names, Variable value, const std::string& description);
    Option add_numbered(const std::string& names, const std::function<void(const int&)>& set,
                        const std::map<std::string, int>& numbers, const std::string& description);

    CLI::App* app_;
};

// Runs the command that the arguments name, one of those that `add_commands` adds, or prints help. Throws UsageError,
// and whatever the command throws.
void run_command_line(int argc, char** argv, void (*add_commands)(Command app));

// --device, for every command that uses one.
void add_device_option(Command command, std::string& select);

// --scan
void add_scan_option(Command command, std::string& scan);

// --path; the value that `path` has is the default.
void add_path_option(Command command, UpdatePath& path);

// --renderer; the value that `path` has is the default.
void add_renderer_option(Command command, DrawPath& path);
std::string renderer_name(bool is_native);  // as that option takes it

// --error: PERCENT of the character's size, or 'exact'. Refused with a compiled file, which has its own.
void add_error_option(Command command, CompileSettings& settings);

// --root-motion: JOINT. Added beside --error, and like it refused with a compiled file.
void add_root_motion_option(Command command, CompileSettings& settings);

// -o and --out, required.
void add_out_option(Command command, std::string& out, const std::string& description);

}  // namespace throng::tools
