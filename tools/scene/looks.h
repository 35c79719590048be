// How the characters of a file look, each in its own way: random choices from a .json file (docs/drawing.md#looks).
#pragma once

#include <throng/throng.h>

#include <span>
#include <string>
#include <vector>

namespace throng::tools {

class Looks {
public:
    // Throws CommandError if the file is wrong, or names something that the character does not have.
    Looks(const std::string& file, const Character& character);

    const std::vector<Outfit>& outfits() const { return outfits_; }
    // Looks of instances of the character that stand at these places, for this seed: no two neighbours look alike, as
    // far as the file has choices.
    std::vector<InstanceLook> of_instances(const Character& character, std::span<const Affine> world_from_model,
                                           uint64_t seed) const;

private:
    using Color = std::array<float, 3>;  // linear

    std::vector<Outfit> outfits_;
    std::vector<Color> tints_;  // each instance's tint lies between two of them; none: white
};

// Whether a .json file has looks rather than a controller. False if it cannot be read.
bool is_looks_file(const std::string& file);

}  // namespace throng::tools
