#include "procedural/procedural_reference.h"

#include "procedural/procedural_io.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <numbers>

namespace throng {
namespace io {
namespace {

// The kernel's GLSL source, compiled as C++ for one instance.
struct ProceduralText {
    using Real = double;
    using vec3 = Vector3<Real>;
    using vec4 = Vector4<Real>;
    using SpringState = ProceduralReference::SpringState;

    const Rig& rig;
    const std::vector<uint>& words;
    const std::vector<ProceduralReference::Target>& targets;
    std::vector<SpringState>& springs;
    std::span<Trs<double>> local;
    const AffineT<double>& world_from_model;
    ProceduralPush push;
    uint instance = 0;

    template <class T>
    T load(size_t word, size_t index = 0) const {
        T item;
        std::memcpy(&item, &words[word + index * sizeof(T) / sizeof(uint)], sizeof(T));
        return item;
    }
    WindSettings load_wind(uint word) const { return load<WindSettings>(word); }
    SpringSettings load_spring(uint word) const { return load<SpringSettings>(word); }
    LookAtSettings load_look_at(uint word) const { return load<LookAtSettings>(word); }
    ReachSettings load_reach(uint word) const { return load<ReachSettings>(word); }
    ColliderShape load_collider(uint first, uint index) const { return load<ColliderShape>(first, index); }
    ProceduralJoint load_joint(const ProceduralChain& chain, size_t k) const {
        return load<ProceduralJoint>(chain.first_joint, k);
    }
    vec4 load_target(uint target) const {
        const auto& [place, weight] = targets[target];
        return {place.x, place.y, place.z, weight};
    }
    uint parent_of(uint joint) const { return rig.parents[joint]; }
    const SpringState& load_spring_state(size_t spring) const { return springs[spring]; }
    void store_spring_state(size_t spring, const SpringState& state) { springs[spring] = state; }
    void forget_spring(size_t spring) { springs[spring] = {}; }

    static constexpr Real kPi = std::numbers::pi, kHalfPi = kPi / 2;
    static Real atan_unit(Real r) { return std::atan(r); }
    static Real sin_quarter(Real x) { return std::sin(x); }

#include "gpu/affine.glsl"

    static Affine to_rows(const AffineT<double>& m) {
        const auto row = [&](size_t i) { return vec4(m.row[i][0], m.row[i][1], m.row[i][2], m.row[i][3]); };
        return {row(0), row(1), row(2)};
    }
    Affine placement() const { return to_rows(world_from_model); }
    Affine load_local(uint joint) const { return to_rows(to_affine(local[joint])); }
    void store_turned(uint joint, const vec4& turn, const Affine&) {
        local[joint].rotation = Quaternion<double>{turn.x, turn.y, turn.z, turn.w} * local[joint].rotation;
    }

#include "procedural/frames.glsl"
#include "procedural/wind.glsl"
#include "procedural/springs.glsl"
#include "procedural/aims.glsl"
};

}  // namespace
}  // namespace io

ProceduralReference::ProceduralReference(const ProceduralRules& rules, const Character& character)
    : targets(rules.targets.size()),
      character_(character),
      tables_(make_procedural_tables(rules, character)),
      springs_(tables_.spring_count) {}

void ProceduralReference::update(std::span<Trs<double>> parent_from_joint, const Moment& moment) {
    io::ProceduralPush push{.first_instance = moment.instance, .time_step_s = static_cast<float>(moment.time_step_s)};
    moment.wind.tell(push);
    io::ProceduralText text{character_.rig,    tables_.words,           targets, springs_,
                            parent_from_joint, moment.world_from_model, push};
    for (const ProceduralTables::Dispatch& dispatch : tables_.dispatches)
        for (uint32_t i = 0; i < dispatch.chain_count; ++i)
            text.move_chain(dispatch.kind, text.load<io::ProceduralChain>(dispatch.first_chain, i));
}

}  // namespace throng
