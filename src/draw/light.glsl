// The light of the scene: a sun and its shadows, a sky, what the ground reflects, and fog. The includer declares
// `DrawScene scene` and `shadow_map`.
vec3 xyz(vec4 v) { return v.xyz; }
vec4 heights_at(Whole column, Whole row) {
    const int last = int(scene.shadow.x) - 1;
    vec4 heights;
    for (int i = 0; i < 4; ++i) heights[i] = texelFetch(shadow_map, ivec2(clamp(column + i, 0, last), row), 0).r;
    return heights;
}
bool has_heights(Whole column, Whole row) { return true; }
#include "draw/light_model.glsl"
#include "draw/sun_model.glsl"
