#include "tools/creatures/body.h"

#include "tools/creatures/bones.h"

namespace throng::creature {

uint32_t Chain::joint_at(double t) const {
    if (joint_count == 0 || t < begin) return parent_joint;
    return first_joint + std::min(uint32_t((t - begin) / step), joint_count - 1);
}

uint32_t Builder::with_room(uint32_t joint) const {
    while (room_below(joint) == 0 && joint != 0) joint = body_.parent[joint];
    return joint;
}

void Builder::place(uint32_t joint, double t, double sign, const Outline& outline, const Vec& up) {
    const Vec forward = outline.direction(t) * sign;
    body_.position.resize(body_.parent.size());
    body_.rotation.resize(body_.parent.size());
    body_.position[joint] = outline.at(t).center;
    body_.rotation[joint] = rotation_to(perpendicular(up, forward), forward);
}

void Builder::add_root(const Outline& outline, double t, double sign, const Vec& up) {
    body_.parent = {kNone};
    body_.level = {1};
    --left_;
    place(0, t, sign, outline, up);
}

const Chain& Builder::add(Chain chain) {
    chain.first_joint = body_.joint_count();
    Vec up = chain.up;
    for (uint32_t k = 0; k < chain.joint_count; ++k) {
        const uint32_t joint = body_.joint_count();
        const uint32_t parent = k == 0 ? chain.parent_joint : joint - 1;
        body_.parent.push_back(parent);
        body_.level.push_back(body_.level[parent] + 1);
        place(joint, chain.at(k), chain.step < 0 ? -1 : 1, chain.outline, up);
        up = rotate(body_.rotation[joint], {0, 1, 0});  // carried along, so that the limb does not twist
    }
    left_ -= chain.joint_count;
    body_.chains.push_back(std::move(chain));
    return body_.chains.back();
}

const Chain& Builder::add_limb(Chain limb) {
    limb.joint_count = std::min({limb.joint_count, left_, room_below(limb.parent_joint)});
    limb.step = 1.0 / std::max(limb.joint_count, 1u);
    return add(std::move(limb));
}

const Chain& Builder::add_limb_on(const Chain& chain, double t, Chain limb) {
    limb.parent_joint = with_room(chain.joint_at(t));
    limb.base = influences_at(bones_of(chain), t);
    return add_limb(std::move(limb));
}

std::vector<uint32_t> share_out(uint32_t joint_count, uint32_t wish, uint32_t fewest,
                                const std::function<uint32_t(uint32_t, uint32_t)>& room) {
    uint64_t capacity = 0;
    std::vector<uint32_t> length;
    for (uint32_t count = fewest; capacity < joint_count; count += 1 + count / 16) {
        length.clear();
        capacity = 0;
        for (uint32_t i = 0; i < count; ++i) {
            length.push_back(std::min(wish, room(i, count)));
            capacity += length.back();
        }
    }
    // If there is more room than there are joints, every site gives up its share.
    uint64_t before = 0;
    for (uint32_t& joints : length) {
        const uint64_t after = before + joints;
        joints = uint32_t(after * joint_count / capacity - before * joint_count / capacity);
        before = after;
    }
    return length;
}

}  // namespace throng::creature
