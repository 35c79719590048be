// What an application can do to a struct of the API by mistake: changes of any value that the struct contains.
#pragma once

#include <throng/throng.h>

#include <fuzzer/FuzzedDataProvider.h>

#include <cstddef>
#include <cstdint>
#include <limits>
#include <string>
#include <tuple>
#include <type_traits>

namespace throng::fuzz {

using Input = FuzzedDataProvider;

// Defines members_of(). A new member of a struct fails to compile here: list it.
#define MEMBERS(Type, ...)             \
    inline auto members_of(Type& of) { \
        auto& [__VA_ARGS__] = of;      \
        return std::tie(__VA_ARGS__);  \
    }

MEMBERS(Vec3<float>, x, y, z);
MEMBERS(Vec3<double>, x, y, z);
MEMBERS(Quaternion<float>, x, y, z, w);
MEMBERS(Quaternion<double>, x, y, z, w);
MEMBERS(Trs<float>, rotation, translation, scale);
MEMBERS(Trs<double>, rotation, translation, scale);
MEMBERS(Affine, row);

MEMBERS(AssetNode, name, parent, parent_from_node);
MEMBERS(AssetSkin, name, joints, inverse_binds);
MEMBERS(AssetTrack, node, target, interpolation, times_s, values);
MEMBERS(AssetMorphTrack, node, interpolation, times_s, values);
MEMBERS(AssetClip, name, duration_s, tracks, morph_tracks);
MEMBERS(AssetMaterial, name, base_color, image, alpha_mode, alpha_cutoff, double_sided, filter, wrap_u, wrap_v,
        metallic, roughness, metallic_roughness_image, normal_image, normal_scale, occlusion_image, occlusion_strength,
        emissive, emissive_image);
MEMBERS(AssetImage, name, encoded);
MEMBERS(AssetMorphTarget, positions, normals);
MEMBERS(AssetPrimitive, material, positions, normals, texcoords, colors, influence_count, influence_joints,
        influence_weights, indices, targets);
MEMBERS(AssetMesh, name, weights, target_names, primitives);
MEMBERS(AssetMeshInstance, node, mesh, skin, weights);
MEMBERS(Asset, name, nodes, skins, clips, meshes, mesh_instances, materials, images, warnings);

MEMBERS(Rig, names, parents, nodes, rest, level_count, mean_depth, leaf_count, uniform_scale);
MEMBERS(JointTracks, rotation, translation, scale, unused);
MEMBERS(Clip, name, duration_s, first_time, row_count, row_stride, first_row, channel_count, source_key_count,
        animated_track_count, refined_row_count, dropped_row_count, size_bytes, raw_size_bytes, first_root_row,
        root_row_count, error, first_morph_time, morph_row_count, morph_row_stride, bounds_min, bounds_max);
MEMBERS(Morph, name, node, target, default_weight);
MEMBERS(MorphDelta, position, normal);
MEMBERS(PaletteEntry, joint, joint_from_bind);
MEMBERS(Skin, name, first_entry, joint_count);
MEMBERS(Vertex, position, normal_octahedral, texcoord, color, first_delta);
MEMBERS(Influences, weights, entries);
MEMBERS(MeshSection, node, mesh, primitive, skin, first_vertex, vertex_count, lod_vertex_count, first_influences,
        influence_sets, first_index, index_count, material, first_morph, morph_count);
MEMBERS(Lod, error);
MEMBERS(IndexRange, first_index, index_count);
MEMBERS(Character, name, rig, clips, times_s, packed, keys, words, root_rows, tracks, skins, palette, vertices,
        influences, indices, sections, section_names, lods, lod_ranges, lod_indices, joint_lods, materials, images,
        bounds_min, bounds_max, size, morphs, morph_deltas, morph_tracks, morph_times_s, morph_values, warnings);
#undef MEMBERS

template <class T>
T odd_number(Input& in) {
    using Limits = std::numeric_limits<T>;
    constexpr T kSquareOverflows = 1e20f;  // as a float
    return in.PickValueInArray({T(0), kSquareOverflows, Limits::denorm_min(), Limits::epsilon(), Limits::max(),
                                Limits::lowest(), Limits::infinity(), -Limits::infinity(), Limits::quiet_NaN()});
}

// Changes one of the values that `value` contains, or adds or removes elements of one of its lists.
template <class T>
void change(Input& in, T& value) {
    const auto change_element = [&](auto& list) {
        change(in, list[in.ConsumeIntegralInRange<size_t>(0, list.size() - 1)]);
    };
    if constexpr (std::is_same_v<T, bool>) {
        value = !value;
    } else if constexpr (std::is_enum_v<T>) {
        value = static_cast<T>(in.ConsumeIntegral<uint8_t>());
    } else if constexpr (std::is_floating_point_v<T>) {
        value = in.ConsumeBool() ? odd_number<T>(in) : static_cast<T>(in.ConsumeIntegral<int8_t>());
    } else if constexpr (std::is_integral_v<T>) {
        value = in.ConsumeBool() ? static_cast<T>(value + in.ConsumeIntegralInRange<T>(0, 4) - 2)
                                 : in.ConsumeIntegral<T>();
    } else if constexpr (std::is_same_v<T, std::string>) {
        value = in.ConsumeRandomLengthString(8);
    } else if constexpr (requires { value.fill(value[0]); }) {
        change_element(value);
    } else if constexpr (requires { value.pop_back(); }) {
        switch (in.ConsumeIntegralInRange(0, 7)) {
            case 0: return value.clear();
            case 1: return value.resize(value.size() + in.ConsumeIntegralInRange<size_t>(1, 8));
            case 2: return value.empty() ? void() : value.pop_back();
            case 3: return value.empty() ? void() : value.push_back(typename T::value_type(value.front()));
            default: return value.empty() ? void() : change_element(value);
        }
    } else {
        const auto change_one = [&](auto&... members) {
            size_t before = in.ConsumeIntegralInRange<size_t>(0, sizeof...(members) - 1);
            ((before-- == 0 ? change(in, members) : void()), ...);
        };
        std::apply(change_one, members_of(value));
    }
}

}  // namespace throng::fuzz
