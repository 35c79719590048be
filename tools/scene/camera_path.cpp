#include "tools/scene/camera_path.h"

#include "tools/cli/command.h"
#include "tools/cli/options.h"

#include <algorithm>
#include <cmath>
#include <iomanip>
#include <numbers>
#include <sstream>

namespace throng::tools {
namespace {

Vec3<float> centre_of(const Bounds& bounds) { return (bounds.min + bounds.max) * 0.5f; }

Vec3<float> turned(const Vec3<float>& v, double turn_rad) {
    const auto s = static_cast<float>(std::sin(turn_rad)), c = static_cast<float>(std::cos(turn_rad));
    return {c * v.x + s * v.z, v.y, c * v.z - s * v.x};
}

using Values = std::map<std::string, double>;

// The angle on a path that goes round once in "seconds"; exact for whole periods, however late.
double angle_rad(double time_s, const Values& values) {
    return 2 * std::numbers::pi * std::fmod(time_s / values.at("seconds"), 1.0);
}

Camera fit(double, const CameraSubject& subject, const Values&) {
    return fit_camera(subject.bounds, subject.aspect_ratio);
}

// The fit camera of a drum around the bounds, turned about the drum's axis. A drum looks the same from all sides.
Camera orbit(double time_s, const CameraSubject& subject, const Values& values) {
    const double turn_rad = angle_rad(time_s, values);
    const Vec3<float> centre = centre_of(subject.bounds), half = (subject.bounds.max - subject.bounds.min) * 0.5f;
    // Half the side of the box that is fitted, as a fraction of the drum's radius: from the fit camera's side the box
    // looks about as wide as the drum. Corners of a square crowd pass through the picture's edges
    constexpr float kFitted = 0.72f;
    const float side = std::hypot(half.x, half.z) * kFitted;
    Camera camera = fit_camera({centre - Vec3<float>{side, half.y, side}, centre + Vec3<float>{side, half.y, side}},
                               subject.aspect_ratio);
    const Vec3<float> out = camera.eye - camera.target;
    const Vec3<float> eye = camera.target + Vec3<float>{out.x, out.y * static_cast<float>(values.at("height")), out.z} *
                                                static_cast<float>(values.at("distance"));
    camera.eye = centre + turned(eye - centre, turn_rad);
    camera.target = centre + turned(camera.target - centre, turn_rad);
    return camera;
}

// Goes round above the heads, now nearer to the middle and now farther from it, looking ahead and inwards.
Camera flyover(double time_s, const CameraSubject& subject, const Values& values) {
    const double angle = angle_rad(time_s, values);
    const Vec3<float> centre = centre_of(subject.bounds), extent = subject.bounds.max - subject.bounds.min;
    const auto above = [&](double turn_rad, double radius, float margin, double y) {
        return Vec3<float>{centre.x + static_cast<float>(std::sin(turn_rad) * radius * (extent.x / 2 + margin)),
                           static_cast<float>(y),
                           centre.z + static_cast<float>(std::cos(turn_rad) * radius * (extent.z / 2 + margin))};
    };
    constexpr double kAhead_rad = 1.3;
    return {.eye = above(angle, 0.75 + 0.2 * std::cos(2 * angle), extent.y,
                         subject.bounds.max.y + extent.y * values.at("height")),
            .target = above(angle + kAhead_rad, 0.5, 0, subject.bounds.min.y)};
}

// Goes round outside the crowd at eye level, on a rounded rectangle: |x|^4 + |z|^4 = 1 in half extents.
Camera low(double time_s, const CameraSubject& subject, const Values& values) {
    const double angle = angle_rad(time_s, values);
    const Vec3<float> centre = centre_of(subject.bounds), half = (subject.bounds.max - subject.bounds.min) * 0.5f;
    const float tall = std::max(2 * half.y, 1e-3f), margin = 1.2f * tall;
    const double s = std::sin(angle), c = std::cos(angle), x = s / std::max(double{half.x + margin}, 1e-9),
                 z = c / std::max(double{half.z + margin}, 1e-9);
    const double radius = 1 / std::sqrt(std::sqrt(x * x * x * x + z * z * z * z));
    Camera camera;
    camera.eye = {centre.x + static_cast<float>(s * radius),
                  subject.bounds.min.y + tall * static_cast<float>(values.at("height")),
                  centre.z + static_cast<float>(c * radius)};
    camera.target = {centre.x, subject.bounds.min.y + tall * 0.5f, centre.z};
    return camera;
}

Camera follow(double, const CameraSubject& subject, const Values& values) {
    const Vec3<float> extent = subject.model_bounds.max - subject.model_bounds.min,
                      middle = centre_of(subject.model_bounds);
    const float size = std::max({extent.x, extent.y, extent.z, 1e-6f});
    const auto in_world = [&](float up, float ahead) {
        return transform_point(
            subject.world_from_model,
            Vec3<float>{middle.x, subject.model_bounds.min.y + up * extent.y, middle.z + ahead * size});
    };
    return {.eye = in_world(static_cast<float>(values.at("height")), -static_cast<float>(values.at("distance"))),
            .target = in_world(0.6f, 1)};
}

struct Parameter {
    const char* name;
    double initial, least, most;
};

struct Preset {
    const char *name, *what;
    Camera (*at)(double time_s, const CameraSubject& subject, const Values& values);
    std::vector<Parameter> parameters;
};

constexpr double kLongest_s = 86400;

const std::vector<Preset>& presets() {
    static const std::vector<Preset> presets{
        {"fit", "still, from the front right", fit, {}},
        {"orbit",
         "once around the crowd",
         orbit,
         {{"seconds", 20, 0.1, kLongest_s}, {"distance", 1, 0.1, 10}, {"height", 1, 0, 10}}},
        {"flyover", "around, above the heads", flyover, {{"seconds", 40, 0.1, kLongest_s}, {"height", 1, 0.1, 100}}},
        {"low", "once around at eye level", low, {{"seconds", 60, 0.1, kLongest_s}, {"height", 0.5, 0.01, 10}}},
        {"follow",
         "behind one character and a bit above",
         follow,
         {{"character", 0, 0, 4294967294.0}, {"distance", 2.2, 0.1, 100}, {"height", 1.2, 0, 100}}},
    };
    return presets;
}

auto find_preset(const std::string& name) { return std::ranges::find(presets(), name, &Preset::name); }

std::string names_of(const std::vector<Parameter>& parameters) {
    std::string names;
    for (const Parameter& parameter : parameters) names += (names.empty() ? "" : ", ") + std::string(parameter.name);
    return names;
}

}  // namespace

CameraPath::CameraPath(const std::string& text) : name_(text.substr(0, text.find(':'))) {
    const auto wrong = [&](const std::string& what) { return UsageError("--camera " + text + ": " + what); };
    const auto preset = find_preset(name_);
    if (preset == presets().end())
        throw wrong("there is no such camera path; there are fit, orbit, flyover, low and follow");
    for (const Parameter& parameter : preset->parameters) parameters_[parameter.name] = parameter.initial;
    if (name_ == text) return;
    std::istringstream given(text.substr(name_.size() + 1));
    for (std::string item; std::getline(given, item, ',');) {
        const std::string name = item.substr(0, item.find('=')),
                          value = item.substr(std::min(name.size() + 1, item.size()));
        const auto parameter = std::ranges::find(preset->parameters, name, &Parameter::name);
        if (parameter == preset->parameters.end())
            throw wrong("'" + name + "' is not a parameter of " + name_ +
                        (preset->parameters.empty() ? ", which has none" : "; it has " + names_of(preset->parameters)));
        char* end = nullptr;
        const double number = std::strtod(value.c_str(), &end);
        const bool is_index = name == "character";
        if (value.empty() || *end != '\0' || !(number >= parameter->least && number <= parameter->most) ||
            (is_index && number != std::floor(number))) {
            std::ostringstream range;
            range << std::setprecision(10) << name << " must be a " << (is_index ? "whole " : "") << "number from "
                  << parameter->least << " to " << parameter->most;
            throw wrong(range.str());
        }
        parameters_[name] = number;
    }
}

uint32_t CameraPath::followed_character() const {
    return follows() ? static_cast<uint32_t>(parameters_.at("character")) : 0;
}

Camera CameraPath::at(double time_s, const CameraSubject& subject) const {
    return still_ ? *still_ : find_preset(name_)->at(time_s, subject, parameters_);
}

std::vector<Option> add_camera_options(Command app, CameraOptions& options) {
    std::string help;
    for (const Preset& preset : presets()) {
        help += (help.empty() ? "" : "; ") + std::string(preset.name) + ": " + preset.what;
        if (!preset.parameters.empty()) help += " (" + names_of(preset.parameters) + ")";
    }
    Option camera = app.add_option("--camera", options.path, help + "; for example orbit:seconds=30,height=2")
                        .capture_default_str();
    const auto add_place = [&](const char* name, std::vector<float>& place, const std::string& what) {
        return app.add_option(name, place, what + ", x,y,z in metres").delimiter(',').expected(3).check(finite());
    };
    Option eye = add_place("--eye", options.eye, "where the camera stands");
    Option target = add_place("--target", options.target, "where it looks");
    eye.needs(target).excludes(camera);
    target.needs(eye);
    return {camera, eye, target};
}

CameraPath make_camera_path(const CameraOptions& options) {
    if (options.eye.empty()) return CameraPath(options.path);
    if (options.eye == options.target) throw UsageError("--eye and --target: they must be different points");
    return CameraPath(Camera{.eye = {options.eye[0], options.eye[1], options.eye[2]},
                             .target = {options.target[0], options.target[1], options.target[2]}});
}

}  // namespace throng::tools
