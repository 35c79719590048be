// Reads the transform of another invocation of the subgroup.
Transform shuffled(Transform t, uint source) {
#ifdef SCAN_QUATERNION
    return Similarity(subgroupShuffle(t.rotation, source), subgroupShuffle(t.translation_scale, source));
#else
    return Affine(subgroupShuffle(t.row0, source), subgroupShuffle(t.row1, source), subgroupShuffle(t.row2, source));
#endif
}
