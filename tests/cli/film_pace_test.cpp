// The estimate of how much longer a film takes.
#include "tools/film/film_pace.h"

#include <gtest/gtest.h>

namespace throng::tools {
namespace {

TEST(FilmPace, SkippedFramesDoNotCountAsDrawn) {
    FilmPace pace;
    for (int frame = 0; frame < 1000; ++frame) pace.skipped(0.25);
    EXPECT_EQ(pace.left_s(10, 0), 0) << "none has been drawn";
    pace.drew(3);
    pace.drew(5);
    EXPECT_EQ(pace.left_s(10, 0), 40);
    EXPECT_EQ(pace.left_s(10, 30), 47.5) << "of a shard, which steps over the others' frames";
}

}  // namespace
}  // namespace throng::tools
