// Alpha to coverage: a transparent fragment covers only some of a pixel's samples. Alpha levels finer than the samples
// of one pixel are dithered over 4 x 4 pixels in Bayer's order (B. E. Bayer, An optimum method for two-level rendition
// of continuous-tone pictures, 1973). So characters need not be sorted, what lies behind shows through, and depths,
// shadows and occlusion work as for everything else. C++ too.

// 0..15, a different one for each of 4 x 4 pixels.
uint bayer_rank(uint x, uint y) {
    const uint both = x ^ y;
    return (both & 1u) << 3 | (y & 1u) << 2 | (both & 2u) | (y & 2u) >> 1;
}

// The PCG hash (M. Jarzynski and M. Olano, Hash Functions for GPU Rendering, 2020).
uint hash_of(uint number) {
    const uint state = number * 747796405u + 2891336453u, word = ((state >> ((state >> 28) + 4u)) ^ state) * 277803737u;
    return (word >> 22) ^ word;
}

// The layer of one section of one instance: a hash that covers() takes, the same for all its fragments. Instances are
// counted over all crowds of the picture.
uint coverage_layer(uint instance, uint section) { return hash_of(instance ^ section << 24); }

// Each layer begins at a different rank in each block of 4 x 4 pixels, so that over several blocks one layer shows
// through another in the right proportion.
bool covers(float alpha, uint x, uint y, uint sample_number, uint sample_count, uint layer) {
    const uint level_count = 16u * sample_count, first = hash_of(hash_of(layer + (x >> 2)) + (y >> 2));
    const uint rank = (16u * sample_number + bayer_rank(x, y) + first) % level_count;
    return alpha * float(level_count) > float(rank) + 0.5f;
}
