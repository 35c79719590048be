// The camera as the user moves it: around a place, along the picture, or through the crowd. No window is involved.
#pragma once

#include <throng/draw.h>

#include <limits>

namespace throng::view {

// A rectangle of a picture; 0 is its left or upper edge, 1 its right or lower one.
struct PicturePart {
    float left = 0, top = 0, right = 1, bottom = 1;

    float width() const { return right - left; }
    float height() const { return bottom - top; }
};

class Orbit {
public:
    // Looks as `camera` does; its distance decides how fast fly() goes and how far zoom() can go.
    void reset(const Camera& camera);
    // Looks as fit_camera() does, so that camera_around() shows within `part` what that shows.
    void fit(const Bounds& bounds, const PicturePart& part, float aspect_ratio);
    Camera camera() const;

    // The ground's height: turn() and zoom() keep an eye that is above the ground there.
    void stand_on(float ground_y) { ground_y_ = ground_y; }

    // turn(): about the target; look(): about the eye. Radians: to the left, up.
    void turn(float yaw_rad, float pitch_rad);
    void look(float yaw_rad, float pitch_rad);
    // Moves eye and target along the picture: in picture heights at the target's distance.
    void pan(float right, float up);
    // Below 1: closer.
    void zoom(float factor);
    // Moves eye and target, in lengths of reset()'s distance: along the picture's right, the world's up, and forward.
    void fly(float right, float up, float forward);

private:
    Vec3<float> to_eye() const;  // unit
    bool is_above_ground() const { return target_.y + to_eye().y * distance_ >= ground_y_; }
    void stay_above_ground();

    Vec3<float> target_;
    float distance_ = 1, yaw_rad_ = 0, pitch_rad_ = 0, reach_ = 1, field_of_view_rad_ = 0.7f;
    float ground_y_ = -std::numeric_limits<float>::infinity();
};

// A camera at the same eye, for a picture of this aspect ratio. Within `part` it shows what `camera` shows, with the
// target in the middle of the part, where all is as large as if the part were a picture of its own. Towards the
// picture's edges perspective stretches it, so what is at the edge of the part may lie outside.
Camera camera_around(const Camera& camera, const PicturePart& part, float aspect_ratio);

// Converts points of the picture to rays and back. Points of the picture: 0..1 from the left and the top.
class Projection {
public:
    Projection(const Camera& camera, float aspect_ratio);

    struct Ray {
        Vec3<float> origin, direction;  // world space; the direction has any length
    };
    Ray ray(float x, float y) const;
    // z is the distance along the line of sight; it is not positive behind the eye.
    Vec3<float> project(const Vec3<float>& world_place) const;
    const Vec3<float>& right() const { return right_; }  // unit, world space
    const Vec3<float>& up() const { return up_; }

private:
    Vec3<float> eye_, right_, up_, forward_;
    float half_width_, half_height_;
};

}  // namespace throng::view
