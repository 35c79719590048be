// CrowdGroup::skin_pool: shared poses, and the buffers in which skin matrices lie by rows.
#pragma once

#include "crowd/batch_plan.h"

namespace throng {

// Makes the pool of a group that has everything else already, and adds kSharedClipsBuffer to the group. Throws the
// errors that Crowd::create() documents for skin pools.
GroupSkinPool make_skin_pool(Uploads& uploads, SharedRigs& rigs, Group& group, const CrowdGroup& made_of,
                             const CrowdSettings& settings);

// Adds the skin matrices of the group's batches, and their rows.
void plan_skin_pool(BatchPlan& plan);

}  // namespace throng
