// Rows as the fused kernel reads them (fused/from_rows.glsl). Shared by C++ and GLSL.
#ifndef THRONG_ROWS_IO_H
#define THRONG_ROWS_IO_H
#include "gpu/shader_types.h"
THRONG_IO_BEGIN

// kRowsBuffer: [row][column], four signed words of 16 bits each. Columns: the rotations of all joints, the finer parts
// of some rotations, the motions (translation and scale) of joints that do not only turn, and the finer parts of the
// first of these motions.

// kRowJointsBuffer, of each joint, in the order of the columns: kRowJointRows rows.
THRONG_IO_CONSTANT kRowJointRows = 6;
// The range of the rotation, in halves: 32767 times its middle x, y, z, w, then what a word is multiplied by. Words are
// not divided by 32767, so the quaternion's length is about 32767.
THRONG_IO_CONSTANT kRowRange = 0;
THRONG_IO_CONSTANT kRowCentre = 1;  // translation and scale of a joint that only turns; of one that moves, the middle
THRONG_IO_CONSTANT kRowPivot = 2;   // the point that it turns about, and its columns: motion, then finer rotation << 16
THRONG_IO_CONSTANT kRowSpace = 3;   // model_from_joint = the walked matrix * these three rows
// Behind all joints: the steps of motions, a row each.
THRONG_IO_CONSTANT kNoColumn = 0xFFFFu;

// kRowPlacesBuffer: four words a clip, then two words a span of keys.
THRONG_IO_CONSTANT kRowClipWords = 4;  // its first key, 1 / Clip::row_stride (float), its first span's word, 0
THRONG_IO_CONSTANT kRowSpanWords = 2;  // its first row, its pieces (float)

// kBindEntriesBuffer: an entry whose skin matrix is the walked matrix itself.
THRONG_IO_CONSTANT kPlainEntry = 0x80000000u;

THRONG_IO_END
#endif
