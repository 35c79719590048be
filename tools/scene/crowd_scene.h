// A crowd from files and options: who stands where and does what, for commands that show one.
#pragma once

#include "tools/scene/camera_path.h"
#include "tools/cli/command.h"
#include "tools/scene/director.h"
#include "tools/scene/looks.h"
#include "tools/scene/scatter.h"

#include <throng/throng.h>

#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace throng::tools {

struct SceneOptions {
    std::vector<std::string> files;
    std::vector<std::string> controllers;  // "CONTROLLER.json" for all files, or "FILE=CONTROLLER.json"
    std::vector<std::string> looks;        // "LOOKS.json" for all files, or "FILE=LOOKS.json"
    // A clip's name or number for all files, or "FILE=CLIP"; files without one play clips at random
    std::vector<std::string> clips, blends;
    double weight = 0.5;  // of `clips`, where `blends` has a second one
    CompileSettings compile;
    std::string scan = "auto";
    UpdatePath path = UpdatePath::kAuto;
    std::optional<uint32_t> count;
    uint32_t usual_count = 1;      // without `count`, or one of each file if these are more
    std::vector<uint32_t> counts;  // [files], or none: `count` is dealt out evenly
    std::vector<double> sizes;     // [files], or none
    Formation formation = Formation::kGrid;
    double spacing = 1;
    uint64_t seed = 1;
    bool steer = false;
    uint32_t own_poses = 0;  // SkinPool::capacity of each file's characters; 0: no pool
};

// Adds the files and all options of a scene. The parser reports wrong numbers of counts and sizes.
class Command;
void add_scene_options(Command app, SceneOptions& options);
void add_clip_options(Command app, SceneOptions& options);

// How many characters of each file there are, [files]. Throws UsageError, also if `count` is too small for one of each.
std::vector<uint32_t> counts_of(const SceneOptions& options);

// The controller of each file, [files], or an empty name. Throws CommandError.
std::vector<std::string> controller_files(const SceneOptions& options);

// The same for the looks of each file.
std::vector<std::string> look_files(const SceneOptions& options);

// The files, their controllers and looks: what a scene is read from.
std::vector<std::string> input_files(const SceneOptions& options);

// Reads the files, with progress and warnings on stderr, and their controllers and looks. Throws CommandError, also if
// counts or sizes do not fit the files.
struct SceneCast {
    explicit SceneCast(const SceneOptions& options);

    std::vector<uint32_t> counts;                        // [files]
    std::vector<Character> characters;                   // [files]
    std::vector<std::optional<Controller>> controllers;  // [files]
    std::vector<std::optional<Looks>> looks;             // [files]
};

class CrowdScene {
public:
    // `settings` without groups, scan and path, which come from `options`. Throws CommandError, as SceneCast does.
    CrowdScene(const Device& device, const SceneOptions& options, CrowdSettings settings);

    Crowd& crowd() { return *crowd_; }
    const Crowd& crowd() const { return *crowd_; }

    // Whether updates may move characters: controllers by root motion, or steering.
    bool may_move() const { return has_controllers_ || !destinations_.empty(); }
    // Makes subject() describe this character, by its number in the crowd. Throws CommandError if there is none.
    void follow(uint32_t character);
    // What the camera is to show, as the last update left it.
    CameraSubject subject(float aspect_ratio) const;

    // Compiles what updates need, and runs characters with controllers for 12 s, since they would move in step
    // otherwise. With --steer they all set out then. Call it before the first step.
    void start();
    // Directs the controllers, has `update_shown` update the crowd (it may be a renderer that animates and draws at
    // once), and takes the feedback. With --steer the step is split into parts of at most 1/20 s, so that agents see
    // each other in time; only the last part is shown.
    void step(float step_s, const std::function<void(float part_s)>& update_shown);
    // The same without animation: time goes on for all characters, and they end in the same state as after a step that
    // is shown.
    void step_unseen(float step_s);

private:
    struct Kind {
        uint32_t count;
        Bounds model_bounds;
    };
    void update_unseen(float step_s);
    void take_feedback();

    std::optional<Crowd> crowd_;
    std::optional<Director> director_;
    std::vector<Kind> kinds_;                // [files]
    std::vector<Affine> placement_;          // [characters], as they were placed
    Bounds bounds_;                          // of the crowd in its first places
    std::vector<Vec3<float>> destinations_;  // [characters], with --steer
    Affine world_from_followed_;
    Bounds followed_bounds_;
    bool culls_ = false, has_controllers_ = false;
};

}  // namespace throng::tools
