// Camera paths around a crowd: functions of time alone, smooth and periodic, so that any frame can be drawn without
// the frames before it.
#pragma once

#include <throng/draw.h>

#include <map>
#include <optional>
#include <string>
#include <vector>

namespace throng::tools {

// What the camera is to show; world space.
struct CameraSubject {
    Bounds bounds;  // of the crowd
    float aspect_ratio = 1;
    Affine world_from_model;  // of the character that is followed
    Bounds model_bounds;      // of its rest pose, model space
};

class CameraPath {
public:
    // "fit", "orbit", "flyover", "follow" or "low", with or without parameters: "orbit:seconds=20,height=1.5". --help
    // lists them. Throws CommandError.
    explicit CameraPath(const std::string& text = "fit");

    // A camera that stands still.
    explicit CameraPath(const Camera& still) : still_(still) {}

    Camera at(double time_s, const CameraSubject& subject) const;
    // Whether CameraSubject needs a character to follow, and which.
    bool follows() const { return name_ == "follow"; }
    uint32_t followed_character() const;

private:
    std::string name_;
    std::map<std::string, double> parameters_;
    std::optional<Camera> still_;
};

// The values of --camera, --eye and --target.
struct CameraOptions {
    std::string path = "fit";
    std::vector<float> eye, target;  // 3 numbers each, or none
};
class Command;
class Option;
// Returns the three options.
std::vector<Option> add_camera_options(Command app, CameraOptions& options);
// Throws CommandError.
CameraPath make_camera_path(const CameraOptions& options);

}  // namespace throng::tools
