// The format of rows for the fused kernel (fused/from_rows.glsl). Shared by C++ and GLSL.
#ifndef THRONG_ROWS_IO_H
#define THRONG_ROWS_IO_H
#include "gpu/shader_types.h"
THRONG_IO_BEGIN

// kRowsBuffer: [row][column], four signed 16-bit words each. Columns: the rotations of all joints; the low-order words
// of some rotations; the motions (translation and scale) of joints that do not only rotate; and the low-order words of
// the first of these motions.

// kRowJointsBuffer: [kRowJointRows][joint], joints in the order of their columns.
THRONG_IO_CONSTANT kRowJointRows = 6;
// The range of the rotation, as eight halves: 32767 times the middle of x, y, z and w, then the factors of their words.
// Words are not divided by 32767, so the quaternion's length is about 32767.
THRONG_IO_CONSTANT kRowRange = 0;
THRONG_IO_CONSTANT kRowCentre = 1;  // translation and scale if the joint only rotates; otherwise their middle
THRONG_IO_CONSTANT kRowPivot = 2;   // the point it rotates about; then its columns: motion | low-order rotation << 16
THRONG_IO_CONSTANT kRowSpace = 3;   // model_from_joint = the walked matrix * these three rows
// After the rows of the joints: the factors of each motion's words, a row each.
THRONG_IO_CONSTANT kNoColumn = 0xFFFFu;

// kRowPlacesBuffer: four words a clip, then two words a span of keys.
THRONG_IO_CONSTANT kRowClipWords = 4;  // first key, 1 / Clip::row_stride (float), word of the first span, 0
THRONG_IO_CONSTANT kRowSpanWords = 2;  // first row, number of pieces (float)

// kBindEntriesBuffer: flag of entries whose skin matrix is the walked matrix itself.
THRONG_IO_CONSTANT kPlainEntry = 0x80000000u;

THRONG_IO_END
#endif
