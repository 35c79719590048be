#include "tests/host/character_file_cases.h"

#include <string>

namespace throng::test {

Asset make_full_asset(const AssetSettings& settings) {
    Asset asset = make_asset(settings);
    asset.images = {{.name = "sk\xC3\xADn", .encoded = Bytes(33, std::byte{7})}, {.name = "", .encoded = {}}};
    asset.materials = {{.name = "cloth",
                        .base_color = {0.1f, -0.0f, 1, 0.5f},
                        .image = 1,
                        .alpha_mode = AlphaMode::kMask,
                        .alpha_cutoff = 0.25f,
                        .double_sided = true,
                        .filter = TextureFilter::kNearest,
                        .wrap_u = TextureWrap::kMirror,
                        .wrap_v = TextureWrap::kClamp,
                        .metallic = 0.1f,
                        .roughness = 0.2f,
                        .metallic_roughness_image = 0,
                        .normal_image = 1,
                        .normal_scale = -2,
                        .occlusion_image = 0,
                        .occlusion_strength = 0.5f,
                        .emissive = {3, 4, 5},
                        .emissive_image = 1},
                       {.name = std::string("a\0b\n", 4), .image = kNone, .alpha_mode = AlphaMode::kBlend},
                       {.name = "", .image = 0}};
    asset.warnings = {"first", "", "third"};
    asset.meshes[0].primitives[0].material = 2;
    return asset;
}

Bytes small_file(double error) {
    Character character = compiled(make_full_asset({.name = "small.glb",
                                                    .joint_count = 4,
                                                    .clip_count = 2,
                                                    .axis_count = 2,
                                                    .key_count = 3,
                                                    .vertex_count = 6,
                                                    .morph_count = 2}),
                                   {.error = error});
    character.root_rows = {{0, 0, 1, 0}, {0, 1, 0.8f, 0.6f}, {0, 0, 1, 0}, {1, 0, 0, -1}, {1, 2, -1, 0}};
    character.clips[0].root_row_count = character.clips[1].first_root_row = 2;
    character.clips[1].root_row_count = 3;
    return write_character(character);
}

}  // namespace throng::test
