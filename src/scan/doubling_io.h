// The words of a doubling table. Shared by C++ and GLSL.
#ifndef THRONG_DOUBLING_IO_H
#define THRONG_DOUBLING_IO_H
#include "scan/scan_io.h"
THRONG_IO_BEGIN

// links[round * joints + joint]. Each joint writes its two slots alternately, so that its last round writes the slot
// called "last". Its product stays there and is not copied.
THRONG_IO_CONSTANT kDoublingDone = 0xFFFFFFFFu;         // the joint's chain was complete in an earlier round
THRONG_IO_CONSTANT kDoublingAncestorMask = 0xFFFFu;     // the ancestor 2^round joints above
THRONG_IO_CONSTANT kDoublingNoAncestor = 1u << 16;      // round 0 of a chain of one joint
THRONG_IO_CONSTANT kDoublingAncestorInLast = 1u << 17;  // the ancestor's latest product is in its last slot
THRONG_IO_CONSTANT kDoublingToLast = 1u << 18;          // the joint writes its last slot

THRONG_IO_END
#endif
