// The words of a piece table. Shared by C++ and GLSL.
#ifndef THRONG_PIECES_IO_H
#define THRONG_PIECES_IO_H
#include "scan/scan_io.h"
THRONG_IO_BEGIN

// links[]: the three numbers of rows, then the rows; a row has a word for each thread.
THRONG_IO_CONSTANT kPathRows = 0;  // joints from the top of the attachment's piece down to the attachment
THRONG_IO_CONSTANT kRounds = 1;    // row r: the thread of the piece 2^r pieces above
THRONG_IO_CONSTANT kWalkRows = 2;  // joints of the piece: walk words, below
THRONG_IO_CONSTANT kFirstRow = 3;
THRONG_IO_CONSTANT kIdle = 0xFFFFFFFFu;  // in any row: the thread has nothing more to do

// A walk word: the joint, where its parent's transform is, and which slot keeps its own transform for later children.
THRONG_IO_CONSTANT kWalkJointMask = 0xFFFFu;
THRONG_IO_CONSTANT kWalkParentShift = 16;  // kParentIsLast, kParentIsPrefix, or kParentInSlot + slot
THRONG_IO_CONSTANT kWalkKeepShift = 22;    // 0, or 1 + slot
THRONG_IO_CONSTANT kWalkFieldMask = 0x3Fu;
THRONG_IO_CONSTANT kParentIsLast = 0;    // the parent is the previous joint of the walk
THRONG_IO_CONSTANT kParentIsPrefix = 1;  // the parent is the attachment
THRONG_IO_CONSTANT kParentInSlot = 2;

THRONG_IO_END
#endif
