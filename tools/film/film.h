// throng render --frames: a film, or its frames.
#pragma once

#include "tools/film/shot.h"

namespace throng::tools {

void render_film(const RenderOptions& options);

}  // namespace throng::tools
