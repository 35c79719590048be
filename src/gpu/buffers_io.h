// One number for each buffer that throng's kernels read or write: its binding in every shader, its place in a
// BufferTable. The SPIR-V says which of them a kernel uses. What is in them: gpu/buffer_table.cpp. Shared by C++ and
// GLSL.
#ifndef THRONG_BUFFERS_IO_H
#define THRONG_BUFFERS_IO_H
#include "gpu/shader_types.h"
THRONG_IO_BEGIN

// Of a character: what all of its instances share.
THRONG_IO_CONSTANT kTimelineBuffer = 0;
THRONG_IO_CONSTANT kTimesBuffer = 1;
THRONG_IO_CONSTANT kRootRowsBuffer = 2;
THRONG_IO_CONSTANT kTracksBuffer = 3;
THRONG_IO_CONSTANT kKeysBuffer = 4;
THRONG_IO_CONSTANT kWordsBuffer = 5;
THRONG_IO_CONSTANT kPaletteJointsBuffer = 6;
THRONG_IO_CONSTANT kJointFromBindBuffer = 7;
THRONG_IO_CONSTANT kParentsBuffer = 8;
THRONG_IO_CONSTANT kControllerBuffer = 9;
THRONG_IO_CONSTANT kMasksBuffer = 10;
THRONG_IO_CONSTANT kSocketJointsBuffer = 11;
THRONG_IO_CONSTANT kSocketSlotsBuffer = 12;
THRONG_IO_CONSTANT kRulesBuffer = 13;
THRONG_IO_CONSTANT kSetPosesBuffer = 14;
THRONG_IO_CONSTANT kAnimatedJointsBuffer = 15;
THRONG_IO_CONSTANT kScanLinksBuffer = 16;
THRONG_IO_CONSTANT kBindRangesBuffer = 17;
THRONG_IO_CONSTANT kBindEntriesBuffer = 18;
THRONG_IO_CONSTANT kBindsBuffer = 19;
THRONG_IO_CONSTANT kPaletteBySetBuffer = 20;
THRONG_IO_CONSTANT kVerticesBuffer = 21;
THRONG_IO_CONSTANT kInfluencesBuffer = 22;
THRONG_IO_CONSTANT kSkinSectionsBuffer = 23;
THRONG_IO_CONSTANT kListedVerticesBuffer = 24;
THRONG_IO_CONSTANT kMorphDeltasBuffer = 25;
THRONG_IO_CONSTANT kMorphTimelineBuffer = 26;
THRONG_IO_CONSTANT kMorphTimesBuffer = 27;
THRONG_IO_CONSTANT kMorphTracksBuffer = 28;
THRONG_IO_CONSTANT kMorphValuesBuffer = 29;

// Of instances: state, what updates write, and what passes between stages.
THRONG_IO_CONSTANT kPlacementsBuffer = 30;
THRONG_IO_CONSTANT kPlaybacksBuffer = 31;
THRONG_IO_CONSTANT kCursorsBuffer = 32;
THRONG_IO_CONSTANT kCommandsBuffer = 33;
THRONG_IO_CONSTANT kLayersBuffer = 34;
THRONG_IO_CONSTANT kLayersBeforeBuffer = 35;
THRONG_IO_CONSTANT kParametersBuffer = 36;
THRONG_IO_CONSTANT kParametersBeforeBuffer = 37;
THRONG_IO_CONSTANT kVoicesBuffer = 38;
THRONG_IO_CONSTANT kVoiceTimesBuffer = 39;
THRONG_IO_CONSTANT kRootsBuffer = 40;
THRONG_IO_CONSTANT kInertiasBuffer = 41;
THRONG_IO_CONSTANT kInertiaStatesBuffer = 42;
THRONG_IO_CONSTANT kRotationsBuffer = 43;
THRONG_IO_CONSTANT kPosedBuffer = 44;
THRONG_IO_CONSTANT kActiveMorphsBuffer = 45;
THRONG_IO_CONSTANT kTargetsBuffer = 46;
THRONG_IO_CONSTANT kSpringsBuffer = 47;
THRONG_IO_CONSTANT kDestinationsBuffer = 48;
THRONG_IO_CONSTANT kAgentsBuffer = 49;
THRONG_IO_CONSTANT kSocketsBuffer = 50;
THRONG_IO_CONSTANT kSampledPosesBuffer = 51;
THRONG_IO_CONSTANT kFirstPosesBuffer = 52;
THRONG_IO_CONSTANT kSecondPosesBuffer = 53;
THRONG_IO_CONSTANT kLocalBuffer = 54;
THRONG_IO_CONSTANT kModelBuffer = 55;
THRONG_IO_CONSTANT kScratchBuffer = 56;
THRONG_IO_CONSTANT kSkinBuffer = 57;
THRONG_IO_CONSTANT kPreviousSkinBuffer = 58;
THRONG_IO_CONSTANT kSkinAheadBuffer = 59;
THRONG_IO_CONSTANT kSkinnedBuffer = 60;

// Of what a view sees (cull/cull_io.h).
THRONG_IO_CONSTANT kStatesBuffer = 61;
THRONG_IO_CONSTANT kVerdictsBuffer = 62;
THRONG_IO_CONSTANT kCountsBuffer = 63;
THRONG_IO_CONSTANT kListBuffer = 64;
THRONG_IO_CONSTANT kWorkBuffer = 65;
THRONG_IO_CONSTANT kDispatchesBuffer = 66;
THRONG_IO_CONSTANT kDrawsBuffer = 67;

// Of a crowd.
THRONG_IO_CONSTANT kEventsBuffer = 68;
THRONG_IO_CONSTANT kViewBuffer = 69;
THRONG_IO_CONSTANT kAgentPlacesBuffer = 70;
THRONG_IO_CONSTANT kAgentBucketsBuffer = 71;
THRONG_IO_CONSTANT kDepthsBuffer = 72;
THRONG_IO_CONSTANT kCoarserDepthsBuffer = 73;

THRONG_IO_CONSTANT kBufferCount = 74;

THRONG_IO_END
#endif
