#include "compile/rig/joint_lod.h"

#include "bind/bind_reference.h"
#include "reference/influence_boxes.h"
#include "reference/sampled_poses.h"

#include <algorithm>
#include <limits>
#include <set>
#include <span>
#include <utility>

namespace throng {
namespace {

constexpr uint32_t kPoses = 32;        // of all clips together, to measure displacements in
constexpr uint32_t kPosesOfClip = 8;   // at least, of each clip
constexpr size_t kMaxSteps = 200'000;  // displacements measured in a pose
constexpr double kShare = 0.5;         // of a level's surface error: the most that resting joints may add to it

// [palette_count]: the last skin that has each entry. An entry of a rigid mesh counts as a skin of its own. Goes
// through the skins backwards and visits each entry once, since in a file any number of skins can have the whole
// palette.
std::vector<uint32_t> skins_of_entries(const Character& character) {
    std::vector<uint32_t> skins(character.palette.size());
    std::set<uint32_t> skinless;
    for (uint32_t entry = 0; entry < skins.size(); ++entry) {
        skins[entry] = static_cast<uint32_t>(character.skins.size()) + entry;
        skinless.insert(skinless.end(), entry);
    }
    for (uint32_t skin = static_cast<uint32_t>(character.skins.size()); skin-- > 0;) {
        const Skin& of = character.skins[skin];
        const auto begin = skinless.lower_bound(of.first_entry),
                   end = skinless.lower_bound(of.first_entry + of.joint_count);
        for (auto entry = begin; entry != end; ++entry) skins[*entry] = skin;
        skinless.erase(begin, end);
    }
    return skins;
}

// Palette entries, sorted by joint and then by skin.
class EntryTable {
public:
    explicit EntryTable(const Character& character) : skins_(skins_of_entries(character)) {
        for (uint32_t entry = 0; entry < skins_.size(); ++entry)
            entries_.push_back({character.palette[entry].joint, skins_[entry], entry});
        std::ranges::sort(entries_, {}, &Entry::key);
    }

    struct Entry {
        uint32_t joint = 0, skin = 0, entry = 0;
        std::pair<uint32_t, uint32_t> key() const { return {joint, skin}; }
    };

    std::span<const Entry> of_joint(uint32_t joint) const {
        return std::ranges::equal_range(entries_, joint, {}, &Entry::joint);
    }
    // The entry of `joint` in the same skin as `entry`; kNone if that skin has none.
    uint32_t counterpart(uint32_t entry, uint32_t joint) const {
        const auto found = std::ranges::lower_bound(entries_, std::pair{joint, skins_[entry]}, {}, &Entry::key);
        return found == entries_.end() || found->key() != std::pair{joint, skins_[entry]} ? kNone : found->entry;
    }

private:
    std::vector<uint32_t> skins_;
    std::vector<Entry> entries_;
};

AffineT<double> difference(const AffineT<double>& a, const AffineT<double>& b) {
    AffineT<double> out;
    for (size_t row = 0; row < 3; ++row)
        for (size_t column = 0; column < 4; ++column) out.row[row][column] = a.row[row][column] - b.row[row][column];
    return out;
}

// For each joint, the largest displacement of a vertex if neither the joint nor any joint below it moves, and the
// palette entries of its parent replace theirs.
class JointDisplacements {
public:
    JointDisplacements(const Character& character, const Progress& progress)
        : character_(character),
          parents_(character.rig.parents),
          entries_(character),
          boxes_(bind_boxes(character)),
          boxes_below_(boxes_),
          ends_(parents_.size()),
          bounds_(parents_.size()) {
        for (uint32_t joint = character.rig.joint_count(); joint-- > 0;) {
            ends_[joint] = std::max(ends_[joint], joint + 1);
            const uint32_t parent = parents_[joint];
            if (parent == kNone) continue;
            ends_[parent] = std::max(ends_[parent], ends_[joint]);
            for (const auto& [of_joint, skin, entry] : entries_.of_joint(joint))
                if (const uint32_t counterpart = entries_.counterpart(entry, parent); counterpart != kNone)
                    boxes_below_[counterpart].add(boxes_below_[entry]);
        }
        // One more than a multiple of the clips, so that not all clips are sampled at the same parts of their durations
        const uint32_t pose_count = kPosesOfClip * static_cast<uint32_t>(character.clips.size()) + 1;
        for (const SampledPose& pose : sampled_poses(character, std::max(kPoses, pose_count))) {
            progress.poll();
            measure_in(pose);
        }
    }

    double of(uint32_t joint) const { return bounds_[joint]; }  // infinite for roots

private:
    static constexpr double kInfinity = std::numeric_limits<double>::infinity();

    // Goes from the leaves up. If few joints are below a joint, measures each of them against the joint's parent.
    // Otherwise, so that the work does not grow with the square of a skeleton's depth, bounds the displacement by a
    // sum: how far everything below is displaced if only this joint rests, plus the largest displacement that a joint
    // below causes on its own.
    void measure_in(const SampledPose& pose) {
        const size_t most_below = kMaxSteps / parents_.size();
        const std::vector<AffineT<double>> model_from_bind = bind_reference(character_.palette,
                                                                            model_from_joint_of(character_, pose));
        std::vector<double> furthest(parents_.size()), below(parents_.size());
        for (uint32_t joint = static_cast<uint32_t>(parents_.size()); joint-- > 0;) {
            const uint32_t parent = parents_[joint];
            if (parent == kNone) {
                furthest[joint] = kInfinity;
            } else if (ends_[joint] - joint <= most_below) {
                for (uint32_t one = joint; one < ends_[joint]; ++one)
                    furthest[joint] = std::max(furthest[joint], displaced(one, parent, boxes_, model_from_bind));
            } else {
                furthest[joint] = displaced(joint, parent, boxes_below_, model_from_bind) + below[joint];
            }
            bounds_[joint] = std::max(bounds_[joint], furthest[joint]);
            if (parent != kNone) below[parent] = std::max(below[parent], furthest[joint]);
        }
    }

    double displaced(uint32_t joint, uint32_t above, const std::vector<Box>& boxes,
                     std::span<const AffineT<double>> model_from_bind) const {
        double furthest = 0;
        for (const auto& [of_joint, skin, entry] : entries_.of_joint(joint)) {
            const uint32_t counterpart = entries_.counterpart(entry, above);
            if (counterpart == kNone) return kInfinity;
            if (!boxes[entry].empty)
                furthest = std::max(
                    furthest,
                    displacement(difference(model_from_bind[entry], model_from_bind[counterpart]), boxes[entry]));
        }
        return furthest;
    }

    const Character& character_;
    const std::vector<uint32_t>& parents_;
    EntryTable entries_;
    // [entry], in bind space: the box of its own vertices; the same with those of entries below it in the same skin
    std::vector<Box> boxes_, boxes_below_;
    std::vector<uint32_t> ends_;  // [joint]: end of its subtree, a range, since joints are in depth-first order
    std::vector<double> bounds_;  // [joint]
};

}  // namespace

std::vector<uint32_t> entries_of_lod(const Character& character, uint32_t lod) {
    const EntryTable entries(character);
    std::vector<uint32_t> moving(character.rig.joint_count());  // the joint, or the nearest above that moves
    for (uint32_t joint = 0; joint < moving.size(); ++joint) {
        const bool moves = character.joint_lods.empty() || character.joint_lods[joint] >= lod;
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

std::vector<Influences> influences_of_lod(const Character& character, uint32_t lod) {
    const std::vector<uint32_t> entries = entries_of_lod(character, lod);
    std::vector<Influences> out = character.influences;
    for (Influences& influences : out)
        for (uint16_t& entry : influences.entries) entry = static_cast<uint16_t>(entries[entry]);
    return out;
}

void make_joint_lods(Character& character, const Progress& progress) {
    character.joint_lods.clear();
    if (character.lods.empty() || character.clips.empty()) return;
    const JointDisplacements displacements(character, progress);
    character.joint_lods.resize(character.rig.joint_count());
    for (uint32_t level = 1; level <= character.lods.size(); ++level) {
        Lod& lod = character.lods[level - 1];
        const double most = kShare * double{lod.error};
        double furthest = 0;  // displacement by joints that do not move
        for (uint32_t joint = 0; joint < character.joint_lods.size(); ++joint) {
            const uint32_t parent = character.rig.parents[joint];
            if (parent != kNone && character.joint_lods[parent] < level) continue;
            if (displacements.of(joint) <= most)
                furthest = std::max(furthest, displacements.of(joint));
            else
                character.joint_lods[joint] = level;
        }
        lod.error += static_cast<float>(furthest);
        // If a joint above rests too, the displacement can be less than that of the joints below on their own. Errors
        // must not get smaller from level to level
        if (level > 1) lod.error = std::max(lod.error, character.lods[level - 2].error);
    }
}

}  // namespace throng
