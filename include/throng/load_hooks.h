// Progress and cancellation of calls that take long.
#pragma once

#include <functional>

namespace throng {

// Both are called on the thread that called throng, and not after the call has returned. What they throw ends the call
// with kInvalidArgument.
struct LoadHooks {
    // The fraction of the work that is done: 0..1, never less than before; 1 only at the end of a call that succeeds.
    std::function<void(double part_done)> progress{};
    // Called very often, so it should do no more than read a flag. Once it returns true, the call ends with kCancelled,
    // most often within 50 ms. It is not called while a mesh is decompressed or its vertices are sorted, which takes a
    // second for a million triangles.
    //
    // A malicious Draco mesh can keep libdraco busy for hours, and cannot be cancelled: read untrusted files in a
    // process that can be ended.
    std::function<bool()> is_cancelled{};
};

}  // namespace throng
