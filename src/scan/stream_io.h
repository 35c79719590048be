// The words of a stream of joints. Shared by C++ and GLSL.
#ifndef THRONG_STREAM_IO_H
#define THRONG_STREAM_IO_H
#include "scan/scan_io.h"
THRONG_IO_BEGIN

// links[]: the number of chunks, the number of rounds of each chunk, then two words for each lane of each chunk.
THRONG_IO_CONSTANT kChunkCount = 0;
THRONG_IO_CONSTANT kFirstChunk = 1;

// First word: the joint, and the slot that keeps its transform for children in later chunks (1 + slot, or 0).
THRONG_IO_CONSTANT kStreamJointMask = 0xFFFFu;
THRONG_IO_CONSTANT kStreamIdle = 0xFFFFu;  // in place of a joint: the lane is idle
THRONG_IO_CONSTANT kStreamKeepShift = 16;
// Second word: the parent's lane, or the lane itself if the parent is not in the chunk; the index of the joint's
// character among those that share the lanes; and the slot of the lowest ancestor in an earlier chunk (1 + slot, or 0).
THRONG_IO_CONSTANT kStreamLaneMask = 0xFFu;
THRONG_IO_CONSTANT kStreamCharacterShift = 8;
THRONG_IO_CONSTANT kStreamCharacterMask = 0xFFu;
THRONG_IO_CONSTANT kStreamSlotShift = 16;

THRONG_IO_END
#endif
