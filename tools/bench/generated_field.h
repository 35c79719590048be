// What `bench view` and `bench million` look at: a field of one character, from a file or generated.
#pragma once

#include "tools/cli/options.h"

#include <throng/crowd.h>

#include <string>
#include <vector>

namespace throng::tools {

struct FieldOptions {
    std::string file;  // empty: a generated creature
    uint32_t count = 0, joints = 64, levels = 16, faces = 500;
    uint64_t seed = 1;
    CompileSettings compile;
};

// `options.count` is the default.
void add_field_options(Command command, FieldOptions& options);

struct Field {
    std::string configuration;  // its name
    Character character;
    std::vector<Playback> playback;  // [count]
    std::vector<Affine> placement;
};
Field make_field(const FieldOptions& options);

}  // namespace throng::tools
