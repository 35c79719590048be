// The words of a piece table. Shared by C++ and GLSL.
#ifndef THRONG_PIECES_IO_H
#define THRONG_PIECES_IO_H
#include "scan/scan_io.h"
THRONG_IO_BEGIN

// links[]: three counts of rows, then the rows, a word for each thread.
THRONG_IO_CONSTANT kPathRows = 0;  // the joints from the top of the attachment's piece down to the attachment
THRONG_IO_CONSTANT kRounds = 1;    // row r: the thread of the 2^r-th piece above
THRONG_IO_CONSTANT kWalkRows = 2;  // the joints of the piece: kWalk words
THRONG_IO_CONSTANT kFirstRow = 3;
THRONG_IO_CONSTANT kIdle = 0xFFFFFFFFu;  // in any row: nothing (more) to do

// A walk's word: the joint, where its parent's transform is, and where to keep its own for later children.
THRONG_IO_CONSTANT kWalkJointMask = 0xFFFFu;
THRONG_IO_CONSTANT kWalkParentShift = 16;  // kParentIsLast, kParentIsPrefix, or kParentInSlot + slot
THRONG_IO_CONSTANT kWalkKeepShift = 22;    // 0, or 1 + slot
THRONG_IO_CONSTANT kWalkFieldMask = 0x3Fu;
THRONG_IO_CONSTANT kParentIsLast = 0;    // the joint before it
THRONG_IO_CONSTANT kParentIsPrefix = 1;  // the attachment
THRONG_IO_CONSTANT kParentInSlot = 2;

THRONG_IO_END
#endif
