#include "base/text.h"
#include "tools/cli/command.h"
#include "tools/cli/inputs.h"
#include "tools/commands.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <utility>

namespace throng::tools {
namespace {

bool is_gltf_name(const std::filesystem::path& path) {
    const std::string ending = ascii_lower(path.extension().string());
    return ending == ".glb" || ending == ".gltf";
}

struct CompileOptions {
    std::string file, out;
    std::vector<std::string> clips, meshes;  // files to take them from
    CompileSettings settings;
    bool json = false;
};

Character compile(const CompileOptions& options) {
    std::vector<std::string> inputs{options.file};
    for (const auto* files : {&options.clips, &options.meshes})
        inputs.insert(inputs.end(), files->begin(), files->end());
    protect_inputs(inputs, {options.out});
    for (const std::string& input : inputs) {
        if (!is_compiled_file(input)) continue;
        unwrap(load_character(input));  // reports damage first
        throw CommandError(input + " is compiled already; give its source, a glTF file");
    }
    // The output may exist and be another kind of file.
    std::error_code unknown;
    if (std::filesystem::exists(options.out, unknown) && !is_compiled_file(options.out))
        throw CommandError(options.out +
                           " exists and is not a compiled character; give --out another name, or remove it");
    if (is_gltf_name(options.out))
        throw UsageError(options.out + ": the output is not a glTF file; give a name that ends in .throng");
    print_progress("reading " + options.file);
    Asset asset = unwrap(load_asset(options.file));
    for (const auto& [files, add] : {std::pair{&options.meshes, &add_meshes}, {&options.clips, &add_clips}})
        for (const std::string& file : *files) {
            print_progress("reading " + file);
            unwrap(add(asset, unwrap(load_asset(file))));
        }
    print_progress("compiling " + options.file);
    Character character = unwrap(compile_character(asset, options.settings));
    print_warnings(character.warnings);
    print_progress("writing " + options.out);
    unwrap(save_character(character, options.out));
    print_progress("");
    return character;
}

nlohmann::json to_json(const CompileOptions& options, const Character& character, size_t bytes) {
    const ClipTotals totals(character);
    nlohmann::json clips = nlohmann::json::array();
    for (const Clip& clip : character.clips)
        clips.push_back({{"name", clip.name},
                         {"rows", clip.row_count},
                         {"bytes", clip.size_bytes},
                         {"raw_bytes", clip.raw_size_bytes},
                         {"error_percent", clip.error * 100}});
    return {{"file", options.file},
            {"clips_from", options.clips},
            {"meshes_from", options.meshes},
            {"out", options.out},
            {"bytes", bytes},
            {"joints", character.rig.joint_count()},
            {"packed", character.packed},
            {"error_bound_percent", options.settings.error * 100},
            {"error_percent", totals.error * 100},
            {"clip_bytes", totals.size_bytes},
            {"clip_raw_bytes", totals.raw_size_bytes},
            {"ratio", totals.ratio()},
            {"clips", clips},
            {"warnings", character.warnings}};
}

void print_text(const CompileOptions& options, const Character& character, size_t bytes) {
    const ClipTotals totals(character);
    std::printf("%s: %zu bytes, compiled from %s\n", printable(options.out, std::string::npos).c_str(), bytes,
                printable(options.file, std::string::npos).c_str());
    std::printf("  clips      %zu, %.1f KiB: %.1f times smaller than %.1f KiB of raw floats\n", character.clips.size(),
                static_cast<double>(totals.size_bytes) / 1024, totals.ratio(),
                static_cast<double>(totals.raw_size_bytes) / 1024);
    if (character.packed)
        std::printf("  error      at most %.2g %% of the character's size, measured at the skin; %.4g %% allowed\n",
                    totals.error * 100, options.settings.error * 100);
    else
        std::printf("  error      none: exact keys\n");
}

void run_compile(const CompileOptions& options) {
    const Character character = compile(options);
    const size_t bytes = std::filesystem::file_size(options.out);
    if (options.json)
        print_json(to_json(options, character, bytes));
    else
        print_text(options, character, bytes);
}

}  // namespace

void add_compile(Command app) {
    Command command = app.add_subcommand(
        "compile", "compress a .glb or .gltf file's clips, and write what the GPU reads, to be loaded in one read");
    CompileOptions& options = command.options_of(run_compile);
    command.add_option("file", options.file, "a glTF 2.0 file").required();
    add_out_option(command, options.out, "the .throng file to write; other commands take it in place of its source");
    command.add_option(
        "--clips", options.clips,
        "files whose clips to add after the character's own: files of animation alone, or characters with "
        "the same joint names");
    command.add_option("--meshes", options.meshes,
                       "files whose meshes to add, such as clothes, hair or weapons for the same joint names");
    add_error_option(command, options.settings);
    add_root_motion_option(command, options.settings);
    command.add_flag("--json", options.json, "as JSON");
    command.footer(
        "Examples:\n  throng compile fox.glb -o fox.throng\n  throng compile fox.glb -o fox.throng --error 0.1\n"
        "  throng compile fox.glb -o fox.throng --error exact --json | jq .ratio\n"
        "  throng compile fox.glb -o fox.throng --root-motion b_Hip_01\n"
        "  throng compile knight.glb --clips walk.glb jump.glb -o knight.throng\n"
        "  throng compile knight.glb --meshes helmet.glb cape.glb -o knight.throng\n  throng info fox.throng");
}

}  // namespace throng::tools
