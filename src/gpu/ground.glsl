// Places on the ground are (x, z, cos, sin): a turn about +y, then a shift.
#ifndef THRONG_GPU_GROUND_GLSL
#define THRONG_GPU_GROUND_GLSL

// b, then a.
vec4 compose_places(vec4 a, vec4 b) {
    return vec4(a.z * b.x + a.w * b.y + a.x, a.z * b.y - a.w * b.x + a.y, a.z * b.z - a.w * b.w, a.z * b.w + a.w * b.z);
}

vec4 inverse_place(vec4 a) { return vec4(a.w * a.y - a.z * a.x, -(a.z * a.y + a.w * a.x), a.z, -a.w); }

vec4 turned_to_length_one(vec4 a) {
    const float squared = dot(a.zw, a.zw);
    return vec4(a.xy, squared > 1e-12 ? a.zw * inversesqrt(squared) : vec2(1, 0));
}

// A row of an affine matrix times a place.
vec4 placed_row(vec4 row, vec4 place) {
    return vec4(row.x * place.z - row.z * place.w, row.y, row.x * place.w + row.z * place.z,
                row.x * place.x + row.z * place.y + row.w);
}

#endif
