// The colour of triangles at pixels' centres, as character.frag has it: as many at a time as there are lanes.
#pragma once

#include "raster/interpolation.h"
#include "raster/light_text.h"
#include "raster/sample.h"

namespace throng::raster {
namespace {

// What the shading of a triangle at a pixel needs of its draw, lane by lane.
struct ShadeInput {
    using Numbers = float[Lanes::kCount];
    using Words = uint32_t[Lanes::kCount];
    struct alignas(64) Corner {
        Numbers x, y, z;
        Words normal, color;
        Numbers u, v;
    };
    Corner corners[3];
    alignas(64) Numbers side;  // -1 where front faces wind the other way
    alignas(64) Numbers column;
    alignas(64) Numbers size;              // of the character
    alignas(64) Numbers red, green, blue;  // of the draw, where Frame::has_colors

    // Fills a lane; texture coordinates and the draw's colour only where they are read.
    INLINE void set(uint32_t lane, const Draw& draw, uint32_t triangle, uint32_t pixel_column, bool is_textured,
                    bool has_colors) {
        const Section& section = *draw.section;
        for (uint32_t k = 0; k < 3; ++k) {
            const uint32_t vertex = section.corners[k][triangle];
            const float* const from = draw.vertices + place_of(vertex);
            Corner& to = corners[k];
            to.x[lane] = from[0];
            to.y[lane] = from[kFour];
            to.z[lane] = from[2 * kFour];
            __builtin_memcpy(&to.normal[lane], from + 3 * kFour, sizeof(uint32_t));
            to.color[lane] = section.colors[vertex];
            if (!is_textured) continue;
            to.u[lane] = section.texcoords[2 * size_t{vertex}];
            to.v[lane] = section.texcoords[2 * size_t{vertex} + 1];
        }
        side[lane] = draw.is_mirrored ? -1 : 1;
        column[lane] = static_cast<float>(pixel_column);
        size[lane] = draw.size;
        if (!has_colors) return;
        red[lane] = draw.color[0];
        green[lane] = draw.color[1];
        blue[lane] = draw.color[2];
    }
    // Copies a lane: a lane without an item repeats another one.
    INLINE void copy(uint32_t lane, uint32_t from) {
        for (Corner& of : corners) {
            of.x[lane] = of.x[from];
            of.y[lane] = of.y[from];
            of.z[lane] = of.z[from];
            of.normal[lane] = of.normal[from];
            of.color[lane] = of.color[from];
            of.u[lane] = of.u[from];
            of.v[lane] = of.v[from];
        }
        side[lane] = side[from];
        column[lane] = column[from];
        size[lane] = size[from];
        red[lane] = red[from];
        green[lane] = green[from];
        blue[lane] = blue[from];
    }
};

INLINE bool is_textured(const Material& material) { return material.base_color_map || material.has_maps; }

// As unpack_normal() of skin/normal.glsl, then unit.
INLINE vec3 unpacked_normal(Whole packed) {
    const Real x = max(Real((packed << 16) >> 16) * (1 / 32767.0f), -1),
               y = max(Real(packed >> 16) * (1 / 32767.0f), -1);
    const Real z = 1 - abs(x) - abs(y);
    const Mask is_below = z < 0;
    const auto folded = [](Real a, Real b) { return choose(a >= 0, 1 - abs(b), abs(b) - 1); };
    return normalize(vec3(choose(is_below, folded(x, y), x), choose(is_below, folded(y, x), y), z));
}

// Colours of pixels of one row, all of one material. The light's code is inlined into it.
[[gnu::flatten]] vec3 shaded(const Frame& frame, const TextScene& scene, const Material& material,
                             const ShadeInput& input, float row) {
    LightText text{scene, frame.map, frame.casters};
    vec3 places[3], normals[3], colors[3];
    vec2 texcoords[3];
    ClipPoint clip[3];
    for (int k = 0; k < 3; ++k) {
        const ShadeInput::Corner& corner = input.corners[k];
        places[k] = {load(corner.x), load(corner.y), load(corner.z)};
        clip[k] = to_picture(frame.scene, places[k]);
        normals[k] = unpacked_normal(load_any(corner.normal));
        colors[k] = xyz(unpacked_color(load_any(corner.color)));
        texcoords[k] = {load(corner.u), load(corner.v)};
    }
    const float pixel_x = 2 / static_cast<float>(frame.width), pixel_y = 2 / static_cast<float>(frame.height);
    const Interpolation point(clip, (load(input.column) + 0.5f) * pixel_x - 1, (row + 0.5f) * pixel_y - 1);
    const vec3 world = point.at(places), normal = normalize(point.at(normals));
    const vec3 base_color(material.base_color[0], material.base_color[1], material.base_color[2]),
        emissive(material.emissive[0], material.emissive[1], material.emissive[2]);
    // Not below 0, as in character.glsl
    const vec3 color = base_color * max(point.at(colors), vec3(0));
    LightText::Surface surface = text.plain_surface(color, material.metallic, material.roughness, emissive, world,
                                                    normal, load(input.size));
    if (frame.has_colors) surface.albedo = surface.albedo * vec3(load(input.red), load(input.green), load(input.blue));
    if (is_textured(material)) {
        const vec2 texcoord = point.at(texcoords);
        const Steps step_x = point.step_x(pixel_x), step_y = point.step_y(pixel_y);
        const LightText::PixelSteps steps{step_x.sum(places), step_y.sum(places), step_x.sum(texcoords),
                                          step_y.sum(texcoords)};
        const auto texel = [&](const Texture* map) {
            if (!map) return vec4(1);
            return sampled(*map, material.sampling, texcoord, mip_of(*map, steps.texcoord_x, steps.texcoord_y));
        };
        surface.albedo = surface.albedo * xyz(texel(material.base_color_map));
        if (material.has_maps) {
            const vec4 metallic_roughness = texel(material.metallic_roughness_map);
            const LightText::MapTexels maps{metallic_roughness.z, metallic_roughness.y, xyz(texel(material.normal_map)),
                                            texel(material.occlusion_map).x, xyz(texel(material.emissive_map))};
            surface = text.mapped_surface(surface, maps, material.normal_scale, material.occlusion_strength, steps);
        }
    }
    return text.pictured_surface(surface, world, normal, point.area() * load(input.side) < 0);
}

// Colours of the ground, or the sky, in as many columns as there are lanes.
[[gnu::flatten]] vec3 shaded_background(const Frame& frame, const TextScene& scene, uint32_t column, uint32_t row) {
    LightText text{scene, frame.map, frame.casters};
    const Whole columns = lane_numbers() + static_cast<int32_t>(column), rows = static_cast<int32_t>(row);
    const auto ray_through = [&](Whole x, Whole y) {
        return xyz(scene.forward) + xyz(scene.right) * ((Real(x) + 0.5f) * (2 / static_cast<float>(frame.width)) - 1) +
               xyz(scene.down) * ((Real(y) + 0.5f) * (2 / static_cast<float>(frame.height)) - 1);
    };
    const vec3 ray = ray_through(columns, rows);
    if (!any(ray.y < 0)) return text.tone_mapped(text.sky_color(normalize(ray)));
    // Derivatives come from the other pixels of a square of four, as on devices
    const auto position = [&](const vec3& of) { return text.ground_position(text.ground_point(of)); };
    const vec2 at = position(ray);
    return text.background(
        ray, abs(position(ray_through(columns ^ 1, rows)) - at) + abs(position(ray_through(columns, rows ^ 1)) - at));
}

}  // namespace
}  // namespace throng::raster
