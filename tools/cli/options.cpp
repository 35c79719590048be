#include "tools/cli/options.h"

#include "base/replace_file.h"
#include "json/known_names.h"
#include "tools/cli/command.h"

#include <throng/version.h>

#include <CLI/CLI.hpp>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <system_error>
#include <unistd.h>

namespace throng::tools {

namespace {

Check check_of(const CLI::Validator& validator) {
    return {[validator](const std::string& text) { return validator(text); }, validator.get_description()};
}

// The innermost command that the arguments select.
const CLI::App& innermost(const CLI::App& app) {
    const std::vector<CLI::App*> given = app.get_subcommands();
    return given.empty() ? app : innermost(*given.back());
}

// "throng render".
std::string name_of(const CLI::App& command) {
    return (command.get_parent() ? name_of(*command.get_parent()) + " " : "") + command.get_name();
}

// The message for a word that a command does not know.
std::string unexpected(const CLI::App& command, const std::string& word) {
    if (!word.starts_with("-") && !command.get_subcommands({}).empty()) {
        KnownNames commands("command");
        for (const CLI::App* one : command.get_subcommands({})) commands.add(one->get_name());
        return commands.unknown(word);
    }
    KnownNames options("option");
    for (const CLI::Option* option : command.get_options())
        for (const std::string& name : option->get_lnames()) options.add(name);
    const std::string name = word.substr(0, word.find('='));
    const std::string_view near = name.starts_with("--") ? options.nearest(name.substr(2)) : std::string_view();
    return "not expected: " + name + (near.empty() ? "" : "; did you mean --" + std::string(near) + "?");
}

// The first of the unexpected words, in the order of the command line.
std::string first_of(const std::vector<std::string>& unexpected, int argc, char** argv) {
    for (int i = 1; i < argc; ++i)
        if (std::ranges::find(unexpected, argv[i]) != unexpected.end()) return argv[i];
    return unexpected.empty() ? "" : unexpected.front();
}

// A command's own options do nothing where a subcommand of it runs.
void refuse_before(const std::string& subcommand, const CLI::App& command) {
    for (const CLI::Option* option : command.get_options()) {
        if (option->count() == 0 || option == command.get_help_ptr() || option == command.get_version_ptr()) continue;
        const std::string word = option->get_positional() ? option->results().front() : option->get_name();
        throw UsageError(word + " has no effect before '" + subcommand + "'; give the arguments of '" + subcommand +
                         "' after its name");
    }
}

// CLI11 says "Could not convert: --seed = abc".
std::string unconverted(const std::string& message) {
    constexpr std::string_view kBegin = "Could not convert: ", kEquals = " = ";
    const size_t equals = message.find(kEquals);
    if (!message.starts_with(kBegin) || equals == std::string::npos) return message;
    return message.substr(kBegin.size(), equals - kBegin.size()) + ": '" + message.substr(equals + kEquals.size()) +
           "' is not a number that this option can have";
}

}  // namespace

Check range(uint32_t least, uint32_t most) {
    return {[least, most](const std::string& text) {
                const std::optional<uint32_t> number = parse_number(text);
                if (number && *number >= least && *number <= most) return std::string();
                return "'" + text + "' is not a whole number from " + std::to_string(least) + " to " +
                       std::to_string(most);
            },
            CLI::Range(least, most).get_description()};
}

Check range(double least, double most) {
    return {[least, most](const std::string& text) {
                char* end = nullptr;
                const double number = std::strtod(text.c_str(), &end);
                if (end != text.c_str() && *end == '\0' && number >= least && number <= most) return std::string();
                char wanted[64];
                std::snprintf(wanted, sizeof(wanted), "' is not a number from %g to %g", least, most);
                return "'" + text + wanted;
            },
            CLI::Range(least, most).get_description()};
}
Check is_member(const std::vector<std::string>& names) { return check_of(CLI::IsMember(names)); }
Check existing_folder() { return check_of(CLI::ExistingDirectory); }

Check finite() {
    return {[](const std::string& text) {
        return std::isfinite(std::strtof(text.c_str(), nullptr)) ? std::string() : text + " is not a finite number";
    }};
}

Check scan_name(const std::vector<std::string>& others) {
    std::vector<std::string> names = others;
    for (const ScanMethodInfo& method : scan_methods()) names.push_back(method.name);
    std::string list;
    for (const std::string& name : names) list += (list.empty() ? "" : ", ") + name;
    return {[names, list](const std::string& text) {
                const bool known = std::find(names.begin(), names.end(), text.substr(0, text.find(':'))) != names.end();
                return known ? std::string() : "'" + text + "' is not a scan method; the methods are: " + list;
            },
            "METHOD[:THREADS]:{" + list + "}"};
}

Check writable_file() {
    return {[](const std::string& text) -> std::string {
        if (text.empty()) return "the name of the file is empty";
        const std::filesystem::path path = text, target = link_target(path),
                                    folder = target.has_parent_path() ? target.parent_path() : ".";
        std::error_code error;
        const auto type = std::filesystem::status(path, error).type();
        if (access(folder.c_str(), W_OK) != 0)
            return text + " cannot be written: its folder: " + std::generic_category().message(errno);
        if (type == std::filesystem::file_type::none) return text + " cannot be written: " + error.message();
        if (type == std::filesystem::file_type::not_found || type == std::filesystem::file_type::regular) return {};
        return text + " exists and is not a regular file";
    }};
}

Option Option::required() {
    option_->required();
    return *this;
}
Option Option::check(const Check& check) {
    option_->check(CLI::Validator([check](std::string& text) { return check.what_is_wrong(text); }, check.values));
    return *this;
}
Option Option::delimiter(char between) {
    option_->delimiter(between);
    return *this;
}
Option Option::expected(int count) {
    option_->expected(count);
    return *this;
}
Option Option::needs(Option other) {
    option_->needs(other.option_);
    return *this;
}
Option Option::excludes(Option other) {
    option_->excludes(other.option_);
    return *this;
}
Option Option::hide() {
    option_->group("");
    return *this;
}
Option Option::capture_default_str() {
    option_->capture_default_str();
    return *this;
}
Option Option::default_str(const std::string& text) {
    option_->default_str(text);
    return *this;
}
bool Option::empty() const { return option_->empty(); }

Command Command::add_subcommand(const std::string& name, const std::string& description) {
    CLI::App* subcommand = app_->add_subcommand(name, description);
    subcommand->preparse_callback([app = app_, name](size_t) { refuse_before(name, *app); });
    return Command(*subcommand);
}

void Command::require_subcommand(const std::string& names) {
    app_->require_subcommand(0, 1);  // a missing one is reported below; 1 would hide the name of a misspelt one
    app_->callback([app = app_, names] {
        if (app->get_subcommands().empty()) throw CLI::RequiredError("A command: " + names);
    });
}

bool Command::has_subcommand() const { return !app_->get_subcommands().empty(); }

Option Command::add_variable(const std::string& names, Variable value, const std::string& description) {
    return Option(std::visit([&](auto* of) { return app_->add_option(names, *of, description); }, value));
}

Option Command::add_flag(const std::string& names, bool& value, const std::string& description) {
    return Option(app_->add_flag(names, value, description));
}

Option Command::add_numbered(const std::string& names, const std::function<void(const int&)>& set,
                             const std::map<std::string, int>& numbers, const std::string& description) {
    std::string all;
    for (const auto& [name, number] : numbers) all += (all.empty() ? "" : ", ") + name;
    const auto to_number = [numbers, all](std::string& text) {
        const auto found = numbers.find(text);
        if (found == numbers.end()) return "'" + text + "' is not one of " + all;
        text = std::to_string(found->second);
        return std::string();
    };
    CLI::Option* option = app_->add_option_function<int>(names, set, description);
    return Option(option->transform(CLI::Validator(to_number, ""))->type_name("{" + all + "}"));
}

void Command::footer(const std::string& text) { app_->footer(text); }
void Command::callback(std::function<void()> run) { app_->callback(std::move(run)); }

void run_command_line(int argc, char** argv, void (*add_commands)(Command app)) {
    CLI::App app{"throng: GPU skeletal animation for crowds"};
    app.name("throng");
    app.set_version_flag("--version", version());
    app.require_subcommand(0, 1);  // a missing one is reported below; 1 would hide the name of a misspelt one
    app.footer("'throng COMMAND --help' has examples. Exit code: 0 success, 1 failure, more than 1 a wrong option.");
    add_commands(Command(app));
    const auto help_of_command = [&] { return " (" + name_of(innermost(app)) + " --help)"; };
    try {
        app.parse(argc, argv);
        if (app.get_subcommands().empty()) throw CLI::RequiredError("A command");
    } catch (const CLI::Success& help_or_version) {
        app.exit(help_or_version);  // prints it
    } catch (const CLI::ExtrasError&) {
        const std::string word = first_of(app.remaining(true), argc, argv);
        throw UsageError(unexpected(innermost(app), word) + help_of_command());
    } catch (const CLI::ConversionError& error) {
        throw UsageError(unconverted(error.what()) + help_of_command());
    } catch (const CLI::ParseError& error) {
        throw UsageError(error.what() + help_of_command());
    } catch (const UsageError& error) {
        throw UsageError(error.what() + help_of_command());
    }
}

void add_device_option(Command command, std::string& select) {
    command.add_option(
        "--device", select,
        "the device to use: its number, 'cpu', 'native', or a part of its name (default: a hardware GPU if there is "
        "one)");
}

void add_path_option(Command command, UpdatePath& path) {
    command.add_choice<UpdatePath>(
        "--path", path,
        {{"auto", UpdatePath::kAuto},
         {"fused", UpdatePath::kFused},
         {"staged", UpdatePath::kStaged},
         {"native", UpdatePath::kNative},
         {"device", UpdatePath::kDevice}},
        "how crowds are updated. fused: sample, blend, scan and bind in one pass; staged: one after another; device: "
        "fused where it applies, else staged; native: by this machine's processor, on software devices; auto: native "
        "on software devices, else as device");
}

void add_renderer_option(Command command, DrawPath& path) {
    command.add_choice<DrawPath>(
        "--renderer", path, {{"auto", DrawPath::kAuto}, {"native", DrawPath::kNative}, {"vulkan", DrawPath::kDevice}},
        "what draws. vulkan: the device; native: this machine's processor, on native and software devices; auto: "
        "native on these, else vulkan");
}

std::string renderer_name(bool is_native) { return is_native ? "native" : "vulkan"; }

void add_scan_option(Command command, std::string& scan) {
    command.add_option("--scan", scan, "method of the Hierarchy-Scan, optionally with its invocations per character")
        .check(scan_name({"auto"}))
        .capture_default_str();
}

void add_error_option(Command command, CompileSettings& settings) {
    constexpr double kMin_percent = 1e-4, kMax_percent = 10;
    const auto what_is_wrong = [](const std::string& text) -> std::string {
        char* end = nullptr;
        const double percent = std::strtod(text.c_str(), &end);
        const bool is_number = end != text.c_str() && *end == '\0';
        if (text == "exact" || (is_number && percent >= kMin_percent && percent <= kMax_percent)) return {};
        return "'" + text + "' is neither 'exact' nor a percentage from 0.0001 to 10";
    };
    const auto set = [&settings](const std::string& text) {
        settings.error = text == "exact" ? 0 : std::strtod(text.c_str(), nullptr) / 100;
    };
    char by_default[16] = "exact";
    if (settings.error > 0) std::snprintf(by_default, sizeof(by_default), "%g", settings.error * 100);
    CLI::App& app = command.app();
    app.add_option_function<std::string>("--error", set,
                                         "how far compressed clips may displace the skin, in percent of the "
                                         "character's size; 'exact': not compressed")
        ->check(CLI::Validator(what_is_wrong, "PERCENT|exact"))
        ->default_str(by_default);
    app.parse_complete_callback([&app] {
        const auto refuse_compiled = [&](const char* name, const std::string& what) {
            const CLI::Option* option = app.get_option_no_throw(name);
            if (!option || option->count() == 0) return;
            for (const CLI::Option* files : app.get_options([](const CLI::Option* of) { return of->get_positional(); }))
                for (const std::string& file : files->results())
                    if (is_compiled_file(file))
                        throw CommandError(file + " is compiled already, " + what + "; leave out " + name +
                                           ", or give its source");
        };
        refuse_compiled("--error", "with its own error bound");
        refuse_compiled("--root-motion", "with its own root motion or none");
    });
}

void add_root_motion_option(Command command, CompileSettings& settings) {
    command.app()
        .add_option("--root-motion", settings.root_motion_joint,
                    "a joint whose movement over the ground is taken out of the clips; characters with a controller "
                    "then move by it")
        ->type_name("JOINT");
}

void add_out_option(Command command, std::string& out, const std::string& description) {
    command.add_option("-o,--out", out, description).required().check(writable_file());
}

}  // namespace throng::tools
