#include "base/text.h"
#include "tools/cli/command.h"
#include "tools/creatures/creature.h"
#include "tools/creatures/glb_writer.h"
#include "tools/commands.h"

#include <cstdio>
#include <filesystem>
#include <fstream>

namespace throng::tools {
namespace {

struct GenerateOptions {
    std::string kind = "dragon", out;
    std::optional<uint32_t> joints, levels, faces;  // by default what suits the kind
    uint64_t seed = 1;
};

// A mistyped --out could otherwise replace any file.
void check_out(const std::string& out) {
    if (!out.ends_with(".glb"))
        throw UsageError("--out " + out + ": the output is a binary glTF file; give a name that ends in .glb");
    std::error_code unknown;
    if (!std::filesystem::exists(out, unknown)) return;
    std::string magic(4, '\0');
    std::ifstream(out, std::ios::binary).read(magic.data(), std::ssize(magic));
    if (magic != "glTF")
        throw CommandError(out + " exists and is not a binary glTF file; give --out another name, or remove it");
}

void run_generate(const GenerateOptions& options) {
    check_out(options.out);
    CreatureSettings settings = creature_settings(unwrap(creature_kind(options.kind)));
    settings.joint_count = options.joints.value_or(settings.joint_count);
    settings.level_count = options.levels.value_or(settings.level_count);
    settings.face_count = options.faces.value_or(settings.face_count);
    settings.seed = options.seed;
    const Asset asset = unwrap(make_creature(settings));
    const std::vector<std::byte> bytes = unwrap(write_glb(asset));
    write_file(options.out, bytes);
    size_t index_count = 0;
    for (const AssetPrimitive& primitive : asset.meshes[0].primitives) index_count += primitive.indices.size();
    std::printf("%s: %u joints, %u levels, %zu faces, %zu clips, %zu bytes\n",
                printable(options.out, std::string::npos).c_str(), settings.joint_count, settings.level_count,
                index_count / 3, asset.clips.size(), bytes.size());
}

}  // namespace

void add_generate(Command app) {
    Command command = app.add_subcommand("generate", "make a skinned, animated creature of any size");
    GenerateOptions& options = command.options_of(run_generate);
    command.add_option("kind", options.kind, "dragon, willow, walker or centipede").capture_default_str();
    command.add_option("--joints", options.joints,
                       "exact number of joints (default: 300, 240, 160 and 1,000, by kind)");
    command.add_option("--levels", options.levels,
                       "exact number of joints on the longest path from the root (default: 60, 30, 40 and 330)");
    command.add_option("--faces", options.faces,
                       "approximate number of triangles (default: 1,500, 3,000, 2,500 and 3,000)");
    command.add_option("--seed", options.seed, "seed of proportions, colours and phases").capture_default_str();
    add_out_option(command, options.out, "the .glb file to write");
    command.footer(
        "Examples:\n  throng generate --out dragon.glb\n  throng generate willow --seed 7 --out willow.glb\n"
        "  throng generate walker --joints 300 --levels 120 --faces 3000 --out deep.glb\n  throng generate centipede "
        "--out centipede.glb");
}

}  // namespace throng::tools
