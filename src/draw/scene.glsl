// The scene of the picture, for all shaders of the draw.
#include "draw/draw_io.h"
#include "gpu/buffers_io.h"

layout(set = 1, binding = kSceneBuffer, std140) uniform Scene { DrawScene scene; };
