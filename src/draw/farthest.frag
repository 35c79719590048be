// farthest: the farthest depth of a pixel's samples. This is the minimum, since depth is reversed. A device need not be
// able to resolve to the minimum (lavapipe is not).
layout(set = 0, binding = 0) uniform sampler2DMS depths;
layout(location = 0) out float out_depth;

void main() {
    const int count = textureSamples(depths);
    out_depth = 1;
    for (int i = 0; i < count; ++i) out_depth = min(out_depth, texelFetch(depths, ivec2(gl_FragCoord.xy), i).x);
}
