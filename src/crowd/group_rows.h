// The rows of a group's clips, which kernels read in place of keys, and the matrices that go with them.
#pragma once

#include "crowd/shared_rigs.h"
#include "fused/fused.h"
#include "gpu/upload.h"
#include "native/gpu_rows.h"

#include <memory>
#include <vector>

namespace throng {

class GroupRows {
public:
    // `finest`: all joints of the character, in the order of the rows' columns. Adds its buffers to `buffers`. Null if
    // the character's joints have several scales, or its rows are more than a kernel of the device can bind.
    static std::shared_ptr<const GroupRows> make(Uploads& uploads, SharedRigs& rigs, const Character& character,
                                                 const FusedRig& finest, Buffers& buffers);

    GroupRows(const Character& character, const native::RowSpaces& spaces, const FusedRig& finest, const GpuRows& rows);

    // The tables of upload_fused_tables() for a set of joints, and the columns of the joints.
    Buffers upload_tables(Uploads& uploads, const Character& character, const FusedRig& rig,
                          const FusedPlan& plan) const;
    FusedRows of_set(uint32_t set) const;

private:
    FusedRows counts_;
    FusedBinds binds_;
    std::vector<uint32_t> columns_;  // [joint of the rig]
};

}  // namespace throng
