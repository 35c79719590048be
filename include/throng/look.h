// How instances of one group look: which sections of the mesh each shows, with which material and in which colours.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

namespace throng {

// How an outfit shows a section of the mesh.
struct SectionLook {
    uint32_t section = 0;                 // of Character::sections
    bool is_shown = true;                 // else it is left out, of shadows too
    std::optional<uint32_t> material{};   // of Character::materials, in place of the section's own
    std::array<float, 3> color{1, 1, 1};  // linear; times the base colour of material, texture and vertices; 0..1000
    float tint = 1;                       // how much of InstanceLook::tint colours it, 0..1
};

// One of the ways in which instances of a group may look (CrowdGroup::outfits). Sections that it does not name are
// shown in their own colours, and take all of the tint.
struct Outfit {
    std::vector<SectionLook> sections{};
};

// How an instance looks; the defaults are the look of a new one. An entry of OutputBlock::look.
struct InstanceLook {
    std::array<float, 3> tint{1, 1, 1};  // linear; 0..1000
    uint32_t outfit = 0;                 // of CrowdGroup::outfits
};

}  // namespace throng
