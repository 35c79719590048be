#include "compile/joint_detail.h"

#include "compile/influence_boxes.h"
#include "sample/sample_reference.h"
#include "scan/scan_reference.h"

#include <algorithm>
#include <span>
#include <utility>

namespace throng {
namespace {

constexpr uint32_t kMostPoses = 32;  // that errors are measured in, of all clips together; at least one a clip

// [palette_count], the skin of each entry; of rigid meshes one that no other has.
std::vector<uint32_t> skins_of_entries(const Character& character) {
    std::vector<uint32_t> skins(character.palette.size());
    for (uint32_t entry = 0; entry < skins.size(); ++entry) skins[entry] = static_cast<uint32_t>(character.skins.size()) + entry;
    for (uint32_t skin = 0; skin < character.skins.size(); ++skin) {
        const Skin& of = character.skins[skin];
        std::fill_n(skins.begin() + of.first_entry, of.joint_count, skin);
    }
    return skins;
}

// Not finite where there is none.
AffineT<double> inverse(const AffineT<double>& m) {
    const auto column = [&](size_t k) { return Vec3<double>{m.row[0][k], m.row[1][k], m.row[2][k]}; };
    const double scale = 1 / determinant(m);
    const std::array rows{cross(column(1), column(2)) * scale, cross(column(2), column(0)) * scale, cross(column(0), column(1)) * scale};
    AffineT<double> out;
    for (size_t r = 0; r < 3; ++r) out.row[r] = {rows[r].x, rows[r].y, rows[r].z, -dot(rows[r], column(3))};
    return out;
}

// Palette entries by joint, and within a joint by skin.
class EntryTable {
public:
    explicit EntryTable(const Character& character) : skins_(skins_of_entries(character)) {
        for (uint32_t entry = 0; entry < skins_.size(); ++entry) entries_.push_back({character.palette[entry].joint, skins_[entry], entry});
        std::ranges::sort(entries_, {}, &Entry::key);
    }

    struct Entry {
        uint32_t joint = 0, skin = 0, entry = 0;
        std::pair<uint32_t, uint32_t> key() const { return {joint, skin}; }
    };

    std::span<const Entry> of_joint(uint32_t joint) const { return std::ranges::equal_range(entries_, joint, {}, &Entry::joint); }
    // Of another joint, in the entry's skin; kNone where it has none.
    uint32_t counterpart(uint32_t entry, uint32_t joint) const {
        const auto found = std::ranges::lower_bound(entries_, std::pair{joint, skins_[entry]}, {}, &Entry::key);
        return found == entries_.end() || found->key() != std::pair{joint, skins_[entry]} ? kNone : found->entry;
    }

private:
    std::vector<uint32_t> skins_;
    std::vector<Entry> entries_;
};

// [pose][joint], model_from_joint at times spread evenly over the clips.
std::vector<std::vector<AffineT<double>>> sampled_poses(const Character& character) {
    std::vector<std::vector<AffineT<double>>> poses;
    const auto clip_count = static_cast<uint32_t>(character.clips.size());
    const uint32_t of_each = std::max(1u, kMostPoses / std::max(clip_count, 1u));
    for (uint32_t clip = 0; clip < clip_count; ++clip)
        for (uint32_t i = 0; i < of_each; ++i) {
            std::vector<AffineT<double>> local;
            for (const Trs<double>& joint : sample_reference(character, clip, (i + 0.5) / of_each * double{character.clips[clip].duration_s})) local.push_back(to_affine(joint));
            poses.push_back(scan_reference(character.rig.parents, local));
        }
    return poses;
}

class JointReducer {
public:
    explicit JointReducer(Character& character) : character_(character), entries_(character), boxes_(influence_boxes(character)), poses_(sampled_poses(character)) {
        // Joints are depth first, so a subtree is a run.
        const uint32_t joint_count = character.rig.joint_count();
        subtree_end_.resize(joint_count);
        for (uint32_t joint = joint_count; joint-- > 0;) {
            subtree_end_[joint] = std::max(subtree_end_[joint], joint + 1);
            if (const uint32_t parent = character.rig.parents[joint]; parent != kNone) subtree_end_[parent] = std::max(subtree_end_[parent], subtree_end_[joint]);
        }
    }

    void reduce(uint32_t detail) {
        const double bound = character_.details[detail - 1].error;
        for (uint32_t joint = 0; joint < subtree_end_.size();) {
            const uint32_t parent = character_.rig.parents[joint];
            if (parent != kNone && rests(joint, parent, bound)) {
                joint = subtree_end_[joint];
                continue;
            }
            character_.joint_details[joint] = detail;
            ++joint;
        }
    }

private:
    // Whether all of the subtree may follow `above` as if nothing between them moved.
    bool rests(uint32_t root, uint32_t above, double bound) const {
        for (uint32_t joint = root; joint < subtree_end_[root]; ++joint)
            for (const auto& [of_joint, skin, entry] : entries_.of_joint(joint)) {
                const uint32_t counterpart = entries_.counterpart(entry, above);
                if (counterpart == kNone) return false;
                const AffineT<double> bind_from_joint = inverse(character_.palette[entry].joint_from_bind.as<double>());
                const AffineT<double> above_from_joint = character_.palette[counterpart].joint_from_bind.as<double>() * bind_from_joint;
                for (const auto& model_from : poses_)
                    if (!(displacement(difference(model_from[joint], model_from[above] * above_from_joint), boxes_[joint]) <= bound)) return false;
            }
        return true;
    }

    static AffineT<double> difference(const AffineT<double>& a, const AffineT<double>& b) {
        AffineT<double> out;
        for (size_t row = 0; row < 3; ++row)
            for (size_t column = 0; column < 4; ++column) out.row[row][column] = a.row[row][column] - b.row[row][column];
        return out;
    }

    Character& character_;
    EntryTable entries_;
    std::vector<Box> boxes_;
    std::vector<std::vector<AffineT<double>>> poses_;
    std::vector<uint32_t> subtree_end_;  // [joint]
};

}  // namespace

std::vector<uint32_t> entries_of_detail(const Character& character, uint32_t detail) {
    const EntryTable entries(character);
    std::vector<uint32_t> moving(character.rig.joint_count());  // the joint, or the nearest above that moves
    for (uint32_t joint = 0; joint < moving.size(); ++joint) {
        const bool moves = character.joint_details.empty() || character.joint_details[joint] >= detail;
        const uint32_t parent = character.rig.parents[joint];
        moving[joint] = moves || parent == kNone ? joint : moving[parent];
    }
    std::vector<uint32_t> out;
    for (uint32_t entry = 0; entry < character.palette.size(); ++entry) {
        const uint32_t joint = character.palette[entry].joint;
        out.push_back(moving[joint] == joint ? entry : entries.counterpart(entry, moving[joint]));
    }
    return out;
}

std::vector<Influences> influences_of_detail(const Character& character, uint32_t detail) {
    const std::vector<uint32_t> entries = entries_of_detail(character, detail);
    std::vector<Influences> out = character.influences;
    for (Influences& influences : out)
        for (uint16_t& entry : influences.entries) entry = static_cast<uint16_t>(entries[entry]);
    return out;
}

void make_joint_details(Character& character) {
    character.joint_details.assign(character.details.empty() ? 0 : character.rig.joint_count(), 0);
    if (character.details.empty()) return;
    JointReducer reducer(character);
    for (uint32_t detail = 1; detail <= character.details.size(); ++detail) reducer.reduce(detail);
}

}  // namespace throng
