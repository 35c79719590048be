// What a kind of creature is: a tree of joints, flesh on it, and how both move.
#pragma once

#include "tools/creatures/clips.h"
#include "tools/creatures/mesh.h"

namespace throng::creature {

struct Material {
    const char* name;
    Vec color;  // linear; multiplies what pieces are painted with
};

struct Model {
    Body body;
    std::vector<Piece> pieces;  // most important first: what does not fit the face budget is left out from the end
    Motion motion;
    std::vector<Material> materials{{"creature", {1, 1, 1}}};
};

Model make_dragon(const CreatureSettings& settings);
Model make_willow(const CreatureSettings& settings);
Model make_walker(const CreatureSettings& settings);
Model make_centipede(const CreatureSettings& settings);

}  // namespace throng::creature
