#include "compile/file/character_check.h"

#include "compile/file/character_layout.h"
#include "compile/file/part_check.h"
#include "compile/limits.h"
#include "compile/clip/packed_track.h"
#include "compile/rig/rig.h"
#include "compile/rig/uniform_scale.h"

#include <array>
#include <cmath>
#include <span>

namespace throng {
namespace {

class CharacterCheck : public PartCheck {
public:
    using PartCheck::PartCheck;

    void run() const {
        check_rig();
        check_scalars();
        check_sizes();
        check_clips(c_, place_, code_);
        if (c_.rig.uniform_scale && !has_uniform_scale(c_))
            fail("rig", "uniform_scale is set, but its scales are not uniform");
        check_mesh(c_, place_, code_);
        check_morphs(c_, place_, code_);
        check_materials();
        check_text();
    }

private:
    void check_rig() const {
        const std::vector<uint32_t>& parents = c_.rig.parents;
        if (parents.empty()) fail("rig", "has no joints");
        check_limit("rig", parents.size(), " joints", kJointLimit);
        if (c_.rig.names.size() != parents.size() || c_.rig.nodes.size() != parents.size() ||
            c_.rig.rest.size() != parents.size())
            fail("rig", "the numbers of names, parents, nodes and rest transforms differ");
        for (size_t joint = 0; joint < parents.size(); ++joint) {
            if (parents[joint] >= joint && parents[joint] != kNone)
                fail(at("parents", joint), parents[joint], " is not an earlier joint");
            const Trs<float>& rest = c_.rig.rest[joint];
            const Quaternion<float>& q = rest.rotation;
            if (!all_finite(std::array{q.x, q.y, q.z, q.w}) || !all_finite(rest.translation) || !all_finite(rest.scale))
                fail(at("rest", joint), "is not finite");
        }
        Rig measured;
        measured.parents = parents;
        measure_rig(measured);
        if (measured.level_count != c_.rig.level_count || measured.leaf_count != c_.rig.leaf_count ||
            measured.mean_depth != c_.rig.mean_depth)
            fail("rig", "its numbers of levels and leaves, or its mean depth, do not match its parents");
    }

    void check_scalars() const {
        const Vec3<float>&low = c_.bounds_min, &high = c_.bounds_max;
        if (!is_finite_box(low, high) || low.x > high.x || low.y > high.y || low.z > high.z)
            fail("bounds", "bounds_min, bounds_max and their difference must be finite, and bounds_min not above");
        if (!(c_.size > 0) || !std::isfinite(c_.size)) fail("size", "is not positive and finite");
    }

    void check_sizes() const {
        file::Records none;
        file::visit_sections(
            none, c_, [&](file::SectionId, const char* name, const auto& elements, uint64_t limit_bytes = ~0ull) {
                check_limit(name, std::span(elements).size_bytes(), " bytes", limit_bytes);
            });
        check_count("tracks", c_.tracks.size(), (c_.clips.size() + uint64_t{1}) * c_.rig.joint_count());
        if (c_.packed && c_.words.size() < kPackedWordsBehind)
            fail("words", "has ", c_.words.size(), " elements, fewer than the ", kPackedWordsBehind,
                 " after the last row");
    }

    void check_materials() const {
        for (size_t i = 0; i < c_.materials.size(); ++i) {
            const AssetMaterial& material = c_.materials[i];
            visit_images([&](auto member) {
                if (material.*member != kNone && material.*member >= c_.images.size())
                    fail(at("materials", i), "an image is ", material.*member, ", but there are ", c_.images.size(),
                         " images");
            });
            const std::array factors{material.alpha_cutoff, material.metallic, material.roughness,
                                     material.normal_scale, material.occlusion_strength};
            if (!all_finite(material.base_color) || !all_finite(material.emissive) || !all_finite(factors))
                fail(at("materials", i), "a factor is not finite");
            if (!has_known_values(material))
                fail(at("materials", i), "alpha_mode, filter, wrap_u or wrap_v has an unknown value");
        }
    }

    // Names and warnings are printed: none may send control sequences to a terminal, or look like another line.
    void check_text() const {
        file::visit_strings(c_, [&](const std::string& string) {
            if (printable(string, std::string::npos) != string)
                fail("text", "'", printable(string),
                     "' has control characters or marks that override the text direction, or is not UTF-8; compile it "
                     "again");
        });
    }
};

}  // namespace

void check_character(const Character& character, const std::string& place, ErrorCode code) {
    CharacterCheck(character, place, code).run();
}

}  // namespace throng
