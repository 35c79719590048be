#version 460
// Flat shading: the facet's normal from the derivatives of the position.
layout(location = 0) in vec3 in_world;
layout(location = 1) in vec4 in_color;
layout(location = 0) out vec4 out_color;

void main() {
    const vec3 normal = normalize(cross(dFdx(in_world), dFdy(in_world)));
    out_color = vec4(in_color.rgb * (0.35 + 0.65 * abs(dot(normal, vec3(0.36, 0.8, 0.48)))), 1);
}
