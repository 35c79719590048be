// ground: one triangle over the whole picture, with the ray through each pixel.
#include "draw/scene.glsl"

layout(location = 0) out vec3 out_ray;

void main() {
    const vec2 corner = vec2(gl_VertexIndex == 1 ? 3 : -1, gl_VertexIndex == 2 ? 3 : -1);
    out_ray = scene.forward.xyz + corner.x * scene.right.xyz + corner.y * scene.down.xyz;
    gl_Position = vec4(corner, 0, 1);
}
