// Characters with levels of detail, and poses to look at them in.
#pragma once

#include "tests/test_rig.h"

#include <throng/reference.h>
#include <throng/throng.h>

#include <vector>

namespace throng::test {

Character with_lods();

// A strip that is flat at rest, where a few triangles are as good as many, and rolled up by a clip.
Asset make_strip();

// The rest pose, and poses at random times of clips, other than those that the compiler has sampled.
std::vector<ReferencePose> rest_and_random_poses(const Character& character, int count, Random& random);

}  // namespace throng::test
