#include "tools/bench/generated_field.h"

#include "tools/cli/command.h"
#include "tools/creatures/creature.h"
#include "tools/scene/scatter.h"

#include <filesystem>

namespace throng::tools {

void add_field_options(Command command, FieldOptions& options) {
    Option file = command.add_option("file", options.file,
                                     "a glTF 2.0 or .throng file (default: a generated creature)");
    command.add_option("--count", options.count, "characters").check(range(1u, 10'000'000u)).capture_default_str();
    command.add_option("--joints", options.joints, "joints of the creature").excludes(file).capture_default_str();
    command.add_option("--levels", options.levels, "levels of the creature").excludes(file).capture_default_str();
    command.add_option("--faces", options.faces, "faces of the creature").excludes(file).capture_default_str();
    add_error_option(command, options.compile);
    command.add_option("--seed", options.seed, "seed of creature, clips, times and blends").capture_default_str();
}

Field make_field(const FieldOptions& options) {
    const bool is_generated = options.file.empty();
    Field field{.configuration = std::to_string(options.count) + " x " +
                                 (is_generated ? std::to_string(options.joints) + " joints"
                                               : std::filesystem::path(options.file).filename().string()),
                .character = is_generated
                                 ? unwrap(compile_character(unwrap(make_creature({.joint_count = options.joints,
                                                                                  .level_count = options.levels,
                                                                                  .face_count = options.faces,
                                                                                  .seed = options.seed})),
                                                            options.compile))
                                 : unwrap(load_character(options.file, options.compile)),
                .playback = {},
                .placement = {}};
    Scatter scattered = scatter({&field.character, 1}, {.counts = {options.count}, .seed = options.seed});
    field.playback = std::move(scattered.playback);
    field.placement = std::move(scattered.placement);
    return field;
}

}  // namespace throng::tools
