// The double-precision reference against golden poses.
#include "tests/goldens.h"

namespace throng {
namespace {

using namespace test;

TEST(GoldenReference, MatchesTheGoldenPoses) {
    THRONG_SKIP_WITHOUT(shared_folder("goldens"));
    size_t answer_count = 0;
    for (const Golden& golden : load_goldens()) {
        Comparison worst;
        for (size_t i = 0; i < golden.playbacks.size(); ++i) {
            const ReferencePose pose = *reference_pose(golden.character, golden.playbacks[i]);
            compare(golden, i,
                    {pose.model_from_joint, pose.model_from_bind, reference_positions(golden.character, pose)}, worst);
        }
        report(golden, "reference", worst);
        answer_count += golden.playbacks.size();
    }
    std::printf("compared %zu answers\n", answer_count);
    EXPECT_GT(answer_count, 0u);
}

}  // namespace
}  // namespace throng
