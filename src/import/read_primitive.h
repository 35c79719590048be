// One primitive of a mesh.
#pragma once

#include "import/readers.h"

namespace throng::gltf {

// Counts what was repaired or ignored in vertex attributes. Each kind gives one warning after the last mesh.
struct AttributeNotes {
    // One kind of repair, for one warning.
    struct Repair {
        void add(const std::string& place) {
            if (count++ == 0) first_place = place;
        }

        uint64_t count = 0;
        std::string first_place{};
    };

    uint64_t count = 0;
    Repair taken_as_normalised{}, left_out{};
};

// Raises `needed` to what the primitive needs.
AssetPrimitive read_primitive(Reading& reading, const JsonView& json, const Asset& asset,
                              std::span<const TextureCoordinates> of_materials, AttributeNotes& notes,
                              NeededJoints& needed);

}  // namespace throng::gltf
