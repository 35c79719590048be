#include "native/native_rig.h"

#include "native/row_spaces.h"
#include "native/walk.h"

#include <algorithm>

namespace throng {
namespace {

constexpr size_t kSecondCache = 1 << 20;  // bytes of the second-level cache of most cores

template <class T>
void put(float (&to)[3], const Vec3<T>& v) {
    to[0] = static_cast<float>(v.x);
    to[1] = static_cast<float>(v.y);
    to[2] = static_cast<float>(v.z);
}

}  // namespace

NativeRig::NativeRig(const Character& character, const NativeRigSettings& settings) {
    const Rig& rig = character.rig;
    const bool some_joints = settings.lod > 0 && !character.joint_lods.empty();
    std::vector<bool> moves(rig.joint_count(), true);
    for (size_t joint = 0; some_joints && joint < moves.size(); ++joint)
        moves[joint] = character.joint_lods[joint] >= settings.lod;
    const std::span<const PaletteEntry> palette = settings.sockets_only ? std::span<const PaletteEntry>()
                                                                        : character.palette;
    native::Walk walk = native::plan_walk({.parents = rig.parents,
                                           .moves = moves,
                                           .palette = palette,
                                           .keeps_model = settings.keeps_model && !settings.sockets_only,
                                           .sockets = settings.sockets});
    native::check_key_rows(character, walk.joints.size());
    // Pose overrides may have any scale
    const native::RowSpaces spaces(character, settings.all_move);
    const bool uniform_scale = spaces.uniform_scale;
    for (const uint32_t joint : walk.joints) joints_.push_back(spaces.of_joints[joint]);
    rows_ = native::make_rows(character, joints_, {.uniform_scale = uniform_scale, .all_move = settings.all_move});
    steps_ = std::move(walk.steps);
    for (size_t i = 0; i < steps_.size(); ++i) {
        const native::JointLayout& layout = rows_.layouts[i];
        put(steps_[i].centre, layout.centre);
        put(steps_[i].scale, layout.scale);
        put(steps_[i].pivot, joints_[i].joint_space.translation);
        steps_[i].motion = layout.motion;
        steps_[i].scales = layout.scales;
    }
    emissions_ = std::move(walk.emissions);
    for (size_t i = 0; i < emissions_.size(); ++i) {
        native::Emission& emission = emissions_[i];
        const bool is_skin = emission.kind == native::EmissionKind::kSkin ||
                             emission.kind == native::EmissionKind::kSkinAt;
        AffineT<double> constant = native::to_affine(spaces.of_joints[walk.emitted_joints[i]].joint_space);
        if (is_skin) constant = constant * character.palette[emission.target].joint_from_bind.as<double>();
        if (native::is_identity(constant, character.size)) continue;
        emission.constant = static_cast<uint32_t>(constants_.size() / 12);
        for (const auto& row : constant.as<float>().row) constants_.insert(constants_.end(), row.begin(), row.end());
    }
    joints_of_places_.assign(rows_.place_count(), kNone);
    for (size_t i = 0; i < joints_.size(); ++i) {
        const native::JointLayout& layout = rows_.layouts[i];
        joints_of_places_[i] = joints_[i].joint;
        if (layout.motion != native::kNoIndex)
            joints_of_places_[rows_.first_motion() + layout.motion] = joints_[i].joint;
        if (layout.scales != native::kNoIndex)
            joints_of_places_[rows_.first_scales() + layout.scales] = joints_[i].joint;
    }
    kernel_ = {.rows = rows_.bytes.get(),
               .row_bytes = rows_.row_bytes,
               .prefetches = rows_.row_bytes * rows_.row_count > kSecondCache,
               .clips = rows_.clips.data(),
               .clip_from_track = 1.0 / rig.joint_count(),
               .blocks = rows_.blocks.data(),
               .ranges = reinterpret_cast<const float*>(rows_.ranges.get()),
               .joint_count = static_cast<uint32_t>(steps_.size()),
               .motion_count = rows_.motion_count,
               .scales_count = rows_.scales_count,
               .three_scales = !uniform_scale,
               .steps = steps_.data(),
               .emissions = emissions_.data(),
               .constants = constants_.data(),
               .slot_count = walk.slot_count,
               .place_count = rows_.place_count(),
               .mask_stride = rows_.place_count() + native::Rows::rounded_up(rows_.blocks.size()),
               .rig_joint_count = rig.joint_count(),
               .palette_count = static_cast<uint32_t>(palette.size()),
               .socket_count = static_cast<uint32_t>(settings.sockets.size())};
}

native::AlignedBytes NativeRig::masks_in_order(std::span<const float> masks) const {
    const size_t count = masks.size() / kernel_.rig_joint_count;
    native::AlignedBytes bytes = native::aligned_bytes(count * kernel_.mask_stride * sizeof(float));
    auto* ordered = reinterpret_cast<float*>(bytes.get());
    std::fill_n(ordered, count * kernel_.mask_stride, 0.0f);
    for (size_t mask = 0; mask < count; ++mask) {
        float* places = ordered + mask * kernel_.mask_stride;
        for (size_t place = 0; place < joints_of_places_.size(); ++place) {
            if (joints_of_places_[place] == kNone) continue;
            places[place] = masks[mask * kernel_.rig_joint_count + joints_of_places_[place]];
            float& of_block = places[kernel_.place_count + place / native::kBlockJoints];
            of_block = std::max(of_block, places[place]);
        }
    }
    return bytes;
}

void NativeRig::put_pose(std::span<const Trs<float>> parent_from_joint, std::span<float> pose) const {
    const auto put = [&](size_t place, const std::array<double, 4>& value) {
        float* at = pose.data() + place / native::kBlockJoints * 4 * native::kBlockJoints +
                    place % native::kBlockJoints;
        for (size_t c = 0; c < 4; ++c) at[c * native::kBlockJoints] = static_cast<float>(value[c]);
    };
    for (size_t place = 0; place < kernel_.place_count; ++place) put(place, {0, 0, 0, 1});  // places without a joint
    for (size_t i = 0; i < joints_.size(); ++i) {
        const Trs<double> local = parent_from_joint[joints_[i].joint].as<double>();
        const native::JointLayout& layout = rows_.layouts[i];
        put(i, native::rotation_row(joints_[i], local.rotation));
        if (layout.motion != native::kNoIndex)
            put(rows_.first_motion() + layout.motion, native::motion_row(joints_[i], local, !kernel_.three_scales));
        if (layout.scales != native::kNoIndex)
            put(rows_.first_scales() + layout.scales, {local.scale.x, local.scale.y, local.scale.z, 1});
    }
}

uint64_t NativeRig::size_bytes() const {
    return rows_.size_bytes() + steps_.size() * sizeof(native::WalkStep) +
           emissions_.size() * sizeof(native::Emission) + constants_.size() * sizeof(float);
}

}  // namespace throng
