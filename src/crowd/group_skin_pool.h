// CrowdGroup::skin_pool: shared poses, and the buffers in which skin matrices lie by rows.
#pragma once

#include "crowd/batch_plan.h"

namespace throng {

// Of a group that has everything else already; adds kSharedClipsBuffer to it. Throws what Crowd::create() promises of
// skin pools.
GroupSkinPool make_skin_pool(Uploads& uploads, SharedRigs& rigs, Group& group, const CrowdGroup& made_of,
                             const CrowdSettings& settings);

// The skin matrices of its batches, and their rows.
void plan_skin_pool(BatchPlan& plan);

}  // namespace throng
