#include "tools/command.h"
#include "tools/creature.h"
#include "tools/glb_writer.h"

#include <cstdio>

namespace throng::tools {
namespace {

struct GenerateOptions {
    CreatureSettings creature;
    std::string out;
};

void run_generate(const GenerateOptions& options) {
    const Asset asset = unwrap(make_creature(options.creature));
    const std::vector<std::byte> bytes = unwrap(write_glb(asset));
    write_file(options.out, bytes);
    std::printf("%s: %u joints, %u levels, %zu faces, %zu clips, %zu bytes\n", options.out.c_str(), options.creature.joint_count,
                options.creature.level_count, asset.meshes[0].primitives[0].indices.size() / 3, asset.clips.size(), bytes.size());
}

}  // namespace

void add_generate(CLI::App& app) {
    CLI::App& command = *app.add_subcommand("generate", "make a skinned, animated creature of any size");
    auto options = std::make_shared<GenerateOptions>();
    command.add_option("--joints", options->creature.joint_count, "joints, exactly")->capture_default_str();
    command.add_option("--levels", options->creature.level_count, "joints on the longest path from the root, exactly")->capture_default_str();
    command.add_option("--faces", options->creature.face_count, "triangles, about")->capture_default_str();
    command.add_option("--seed", options->creature.seed, "proportions, colours and phases")->capture_default_str();
    add_out_option(command, options->out, "the .glb file to write");
    command.footer("Examples:\n  throng generate --out dragon.glb\n  throng generate --joints 300 --levels 120 --faces 3000 --seed 7 --out deep.glb");
    command.callback([options] { run_generate(*options); });
}

}  // namespace throng::tools
