// The words of a doubling table. Shared by C++ and GLSL.
#ifndef THRONG_DOUBLING_IO_H
#define THRONG_DOUBLING_IO_H
#include "scan/scan_io.h"
THRONG_IO_BEGIN

// links[round * joints + joint]. Each joint has two slots and writes them in turns, ending with the last slot in its
// last round. Its product stays there: nothing is copied on.
THRONG_IO_CONSTANT kDoublingDone = 0xFFFFFFFFu;         // the joint's chain was complete before
THRONG_IO_CONSTANT kDoublingAncestorMask = 0xFFFFu;     // 2^round above
THRONG_IO_CONSTANT kDoublingNoAncestor = 1u << 16;      // round 0 of a chain of one joint
THRONG_IO_CONSTANT kDoublingAncestorInLast = 1u << 17;  // which of its two slots the ancestor wrote last
THRONG_IO_CONSTANT kDoublingToLast = 1u << 18;          // which slot the joint writes

THRONG_IO_END
#endif
