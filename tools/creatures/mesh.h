// Tubes along limbs, sheets of skin or cloth, and leaves, all of which bones move.
#pragma once

#include "tools/creatures/bones.h"
#include "tools/creatures/palette.h"

#include <variant>

namespace throng::creature {

// How finely a piece is cut in one direction: into `wanted` parts at the kind's usual number of faces, into more or
// fewer parts at other numbers.
struct Cuts {
    double wanted = 1;
    uint32_t least = 1;
    uint32_t step = 1;  // parts come in multiples of it
    uint32_t parts = 0;

    void refine(double factor) {
        const auto steps = uint32_t(wanted / step * factor + 0.5);
        parts = std::max(least, step * std::max(1u, steps));
    }
};

// A limb's skin: rings of at least three vertices, the ends drawn together to a point. The start stays open if it is
// inside another piece.
struct Tube {
    Outline outline;
    double from = 0, to = 1;  // the part of the outline that it covers
    Bones bones;
    Vec up{0, 1, 0};
    Paint paint;
    bool open_start = true;
    Cuts sides{3}, segments;
    bool segments_fixed = false;  // its rings meet another piece's edge
    uint32_t material = 0;        // of the model
};

struct SkinPoint {
    Vec position;
    Influences influences;
};

// A single layer of skin or cloth: (u, v) in 0 … 1.
struct Sheet {
    std::function<SkinPoint(double u, double v)> at;
    Paint paint;            // of u and v
    bool mirrored = false;  // u × v points to its inside
    Cuts along, across;
    uint32_t material = 0;
};

// A diamond from `base` to `base + along`, `across` to each side, lit as if it faced along `normal`: leaves lit by
// their own normals would glitter; lit like the crown that they belong to, they show its shape.
struct Leaf {
    Vec base, along, across, normal, color;
    Influences influences;
};
struct Leaves {
    std::function<Leaf(uint32_t index, uint32_t count)> at;
    Cuts count;
    uint32_t material = 0;
};

using Piece = std::variant<Tube, Sheet, Leaves>;

// Collects the pieces that a kind is made of, the most important one first; make_mesh() makes the mesh of them.
class BodyPieces {
protected:
    explicit BodyPieces(const Body& body) : body_(body) {}

    void add(Piece piece) { pieces_.push_back(std::move(piece)); }
    // Adds a tube along the chain, with the settings of `like` except for outline, bones and up.
    void add_limb(const Chain& chain, Tube like) {
        like.outline = chain.outline;
        like.bones = bones_of(chain);
        like.up = chain.up;
        add(std::move(like));
    }
    void add_limbs(std::string_view part, const Tube& like) {
        for (const Chain& chain : body_.chains_of(part)) add_limb(chain, like);
    }

    const Body& body_;
    std::vector<Piece> pieces_;
};

// Makes about `face_count` triangles, with one primitive for each material in use. Most important pieces first: pieces
// that do not fit are dropped from the end.
AssetMesh make_mesh(std::vector<Piece> pieces, uint32_t face_count);

}  // namespace throng::creature
