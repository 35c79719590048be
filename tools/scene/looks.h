// How the characters of a file look, each in its own way: choices of a .json file (docs/drawing.md#looks), made at
// random.
#pragma once

#include <throng/throng.h>

#include <string>
#include <vector>

namespace throng::tools {

class Looks {
public:
    // Throws CommandError where the file is wrong, or names what the character does not have.
    Looks(const std::string& file, const Character& character);

    const std::vector<Outfit>& outfits() const { return outfits_; }
    // Of so many instances, for this seed.
    std::vector<InstanceLook> of_instances(uint32_t count, uint64_t seed) const;

private:
    using Color = std::array<float, 3>;  // linear

    std::vector<Outfit> outfits_;
    std::vector<Color> tints_;  // each instance's is somewhere between two of them; none: white
};

// Whether the file has what those of looks have, and not a controller, which is also a .json. False where it is none.
bool is_looks_file(const std::string& file);

}  // namespace throng::tools
