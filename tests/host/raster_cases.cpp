#include "tests/host/raster_cases.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>

namespace throng::test {
namespace {

Vec3<double> xyz(const io::vec4& v) { return {v.x, v.y, v.z}; }
io::vec4 vec4_of(const Vec3<double>& v, double w = 0) {
    return {static_cast<float>(v.x), static_cast<float>(v.y), static_cast<float>(v.z), static_cast<float>(w)};
}
// The row whose dot product with a place is `along` times the vector from `from` to the place.
io::vec4 row_along(const Vec3<double>& along, const Vec3<double>& from) { return vec4_of(along, -dot(along, from)); }

io::DrawScene make_scene(uint32_t width, uint32_t height, uint32_t map_size) {
    const Vec3<double> eye{0.3, 1.5, 4}, forward = normalized(Vec3<double>{0, -0.25, -1}),
                                         right = normalized(cross(forward, Vec3<double>{0, 1, 0})),
                                         down = cross(forward, right);
    const double half_width = 0.6, half_height = half_width * height / width;
    io::DrawScene scene{};
    scene.clip_from_world[0] = row_along(right * (1 / half_width), eye);
    scene.clip_from_world[1] = row_along(down * (1 / half_height), eye);
    scene.clip_from_world[2] = {0, 0, 0, kNearPlane};
    scene.clip_from_world[3] = row_along(forward, eye);
    scene.map_from_world[0] = {0.05f, 0.01f, 0.02f, 0.5f};
    scene.map_from_world[1] = {-0.01f, 0.02f, 0.06f, 0.6f};
    scene.map_from_world[2] = {0.02f, 0.1f, 0.03f, 0.4f};
    scene.eye = vec4_of(eye, 1.1);
    scene.forward = vec4_of(forward);
    scene.right = vec4_of(right * half_width);
    scene.down = vec4_of(down * half_height);
    scene.to_sun = vec4_of(normalized(Vec3<double>{0.4, 0.8, 0.45}));
    scene.ground = {0.2f, 0.1f, -1, 1.8f};
    scene.fog = {0.05f, 0, 0, 0};
    scene.picture = {static_cast<float>(width), static_cast<float>(height), 0, 0};
    scene.shadow = {static_cast<float>(map_size), 0.25f, 1, 0};
    scene.sun_light = {1.25f, 1.12f, 0.93f, 0};
    scene.sky_light = {0.34f, 0.42f, 0.55f, 0};
    scene.bounce_light = {0.25f, 0.24f, 0.2f, 0};
    scene.horizon = {0.62f, 0.74f, 0.88f, 0};
    scene.zenith = {0.13f, 0.32f, 0.68f, 0};
    scene.ground_albedo = {0.31f, 0.29f, 0.235f, 0};
    return scene;
}

double encoded(double linear) {
    const double color = std::clamp(linear, 0.0, 1.0);
    return 255 * (color <= 0.0031308 ? 12.92 * color : 1.055 * std::pow(color, 1 / 2.4) - 0.055);
}

// What `draw` writes to a guarded buffer, to which this member of the frame is set.
template <class Value, class Draw>
std::vector<Value> written(const raster::Frame& frame, Value* raster::Frame::*member, size_t count, NativeIsa isa,
                           const Draw& draw) {
    const raster::Kernel& kernel = raster::kernel_of(isa);
    GuardedBytes values(count * sizeof(Value)), scratch(kernel.scratch_bytes(frame));
    raster::Frame into = frame;
    into.*member = reinterpret_cast<Value*>(values.data());
    draw(kernel, into, scratch.data());
    return {into.*member, into.*member + count};
}

}  // namespace

RasterPicture::RasterPicture(uint32_t width, uint32_t height, uint32_t sample_count, uint64_t seed) {
    constexpr uint32_t kMapSize = 64;
    scene = make_scene(width, height, kMapSize);
    frame.width = width;
    frame.height = height;
    frame.sample_count = sample_count;
    frame.map_size = kMapSize;
    Random random(seed);
    for (uint32_t i = 0; i < kMapSize * kMapSize; ++i) map_.push_back(static_cast<float>(random.unit()));
    samples_.resize(size_t{width} * height * sample_count);
    shown_.resize(samples_.size());
    for (uint32_t i = 0; i <= raster::kSrgbSteps; ++i)
        srgb_.push_back(static_cast<uint32_t>(std::lround(encoded(static_cast<double>(i) / raster::kSrgbSteps))));
}

const raster::Texture* RasterPicture::add_texture(const Picture& picture, raster::TexelKind kind) {
    return &textures_.emplace_back(picture, kind).texture();
}

uint32_t RasterPicture::add_draw(const raster::Material& material, std::span<const RasterTriangle> triangles,
                                 bool is_mirrored) {
    drawn_.push_back(
        {.material = &material, .triangles = {triangles.begin(), triangles.end()}, .is_mirrored = is_mirrored});
    return static_cast<uint32_t>(drawn_.size() - 1);
}

void RasterPicture::add_line(const Vec3<float>& color) { lines_.push_back({{}, {color.x, color.y, color.z}}); }

void RasterPicture::finish() {
    static_assert(sizeof frame.scene == sizeof scene);
    std::memcpy(&frame.scene, &scene, sizeof scene);
    for (const DrawData& draw : drawn_) {
        std::vector<RasterVertex> vertices;
        std::vector<uint32_t> corners;
        // Vertices in reverse order, so that only the corners tell which is which
        for (size_t i = 3 * draw.triangles.size(); i-- > 0;) {
            const RasterCorner& corner = draw.triangles[i / 3][i % 3];
            vertices.push_back(
                {.place = corner.place.as<float>(),
                 .normal = corner.normal.as<float>(),
                 .texcoord = {static_cast<float>(corner.texcoord[0]), static_cast<float>(corner.texcoord[1])},
                 .color = std::bit_cast<uint32_t>(corner.color)});
            corners.push_back(static_cast<uint32_t>(i));
        }
        draws_.add(*draw.material, vertices, corners, draw.is_mirrored);
    }
    draws_.set(frame, raster::kernel_of(native_isas().front()));
    // From here on, with the precision that the draws keep
    for (size_t d = 0; d < drawn_.size(); ++d)
        for (size_t i = 0, count = 3 * drawn_[d].triangles.size(); i < count; ++i) {
            RasterCorner& corner = drawn_[d].triangles[i / 3][i % 3];
            corner.place = draws_.place(d, count - 1 - i);
            corner.normal = draws_.normal(d, count - 1 - i);
            for (double& texcoord : corner.texcoord) texcoord = static_cast<double>(static_cast<float>(texcoord));
        }
    frame.lines = lines_.data();
    frame.line_count = static_cast<uint32_t>(lines_.size());
    frame.map = map_.data();
    frame.samples = samples_.data();
    frame.srgb = srgb_.data();
}

void RasterPicture::show(uint32_t x, uint32_t y, uint32_t sample, const Shown& shown) {
    const size_t at = (size_t{y} * frame.width + x) * frame.sample_count + sample;
    shown_[at] = shown;
    const uint32_t id = shown.of_draw == kLines ? frame.first_line_id + shown.triangle
                                                : draws_.first_id(shown.of_draw) + shown.triangle;
    samples_[at] = uint64_t{std::bit_cast<uint32_t>(0.5f)} << 32 | static_cast<uint32_t>(~id);
}

Vec3<double> RasterPicture::ray(double x, double y) const {
    return xyz(scene.forward) + xyz(scene.right) * (2 * x / frame.width - 1) +
           xyz(scene.down) * (2 * y / frame.height - 1);
}

RasterPicture::At RasterPicture::weighted(const RasterTriangle& triangle, const std::array<double, 3>& weights) const {
    At at{.alpha = 0};
    for (size_t k = 0; k < 3; ++k) {
        const RasterCorner& corner = triangle[k];
        at.place = at.place + corner.place * weights[k];
        at.normal = at.normal + corner.normal * weights[k];
        at.color = at.color +
                   Vec3<double>{corner.color[0] / 255.0, corner.color[1] / 255.0, corner.color[2] / 255.0} * weights[k];
        at.alpha += corner.color[3] / 255.0 * weights[k];
        for (size_t i = 0; i < 2; ++i) at.texcoord[i] += corner.texcoord[i] * weights[k];
    }
    at.normal = normalized(at.normal);
    return at;
}

RasterPicture::At RasterPicture::at(const RasterTriangle& triangle, bool is_mirrored, double x, double y) const {
    const Vec3<double> eye = xyz(scene.eye), way = ray(x, y);
    std::array<double, 3> weights{};
    double sum = 0;
    for (size_t k = 0; k < 3; ++k) {
        weights[k] = dot(way, cross(triangle[(k + 1) % 3].place - eye, triangle[(k + 2) % 3].place - eye));
        sum += weights[k];
    }
    for (double& weight : weights) weight /= sum;
    At at = weighted(triangle, weights);
    const Vec3<double> face = cross(triangle[1].place - triangle[0].place, triangle[2].place - triangle[0].place);
    at.is_before_eye = dot(at.place - eye, xyz(scene.forward)) > kNearPlane;
    at.is_front = (dot(face, way) < 0) != is_mirrored;
    return at;
}

RasterPicture::At RasterPicture::at_map(const RasterTriangle& triangle, double x, double y) const {
    std::array<std::array<double, 2>, 3> from{};
    for (size_t k = 0; k < 3; ++k)
        for (size_t i = 0; i < 2; ++i)
            from[k][i] = dot(xyz(scene.map_from_world[i]), triangle[k].place) + double{scene.map_from_world[i].w} -
                         (i == 0 ? x : y) / frame.map_size;
    std::array<double, 3> weights{};
    double sum = 0;
    for (size_t k = 0; k < 3; ++k) {
        const auto &a = from[(k + 1) % 3], &b = from[(k + 2) % 3];
        sum += weights[k] = a[0] * b[1] - b[0] * a[1];
    }
    for (double& weight : weights) weight /= sum;
    return weighted(triangle, weights);
}

bool RasterPicture::is_before(uint32_t x, uint32_t y, const Shown& shown) const {
    const DrawData& draw = drawn_[shown.of_draw];
    return at(draw.triangles[shown.triangle], draw.is_mirrored, x + 0.5, y + 0.5).is_before_eye;
}

Vec3<double> RasterPicture::shaded(const Shown& shown, uint32_t x, uint32_t y) const {
    const auto heights = [this](int column, int row) { return map_height(column, row); };
    const double centre_x = x + 0.5, centre_y = y + 0.5;
    if (shown.of_draw == kNothing)
        return background_reference(scene, heights, ray(centre_x, centre_y), ray((x ^ 1) + 0.5, centre_y),
                                    ray(centre_x, (y ^ 1) + 0.5));
    if (shown.of_draw == kLines) {
        const float* const color = lines_[shown.triangle / 2].color;
        return {color[0], color[1], color[2]};
    }
    const DrawData& draw = drawn_[shown.of_draw];
    const raster::Material& material = *draw.material;
    const auto place_at = [&](double right, double down) {
        return at(draw.triangles[shown.triangle], draw.is_mirrored, centre_x + right, centre_y + down);
    };
    const At at = place_at(0, 0);
    constexpr double kStep = 1e-4;
    const auto step = [&](double right, double down) {
        const At before = place_at(-right * kStep, -down * kStep), after = place_at(right * kStep, down * kStep);
        At changes{.place = (after.place - before.place) * (0.5 / kStep)};
        for (size_t i = 0; i < 2; ++i) changes.texcoord[i] = (after.texcoord[i] - before.texcoord[i]) * (0.5 / kStep);
        return changes;
    };
    const At step_x = step(1, 0), step_y = step(0, 1);
    const auto texel = [&](const raster::Texture* texture) {
        return texture ? sampled_reference(*texture, material.sampling, at.texcoord, step_x.texcoord, step_y.texcoord)
                       : std::array<double, 4>{1, 1, 1, 1};
    };
    const auto product = [](const Vec3<double>& a, const auto& b) {
        return Vec3<double>{a.x * b[0], a.y * b[1], a.z * b[2]};
    };
    const auto first_three = [](const std::array<double, 4>& v) { return Vec3<double>{v[0], v[1], v[2]}; };
    const Vec3<double> color{std::max(at.color.x, 0.0), std::max(at.color.y, 0.0), std::max(at.color.z, 0.0)};
    const LitSurface surface{.place = at.place,
                             .normal = at.normal,
                             .albedo = product(product(color, material.base_color), texel(material.base_color_map)),
                             .metallic = material.metallic,
                             .roughness = material.roughness,
                             .emissive = {material.emissive[0], material.emissive[1], material.emissive[2]},
                             .size = draws_.size(shown.of_draw)};
    return character_reference(scene, heights, surface, at.is_front,
                               {.metallic = texel(material.metallic_roughness_map)[2],
                                .roughness = texel(material.metallic_roughness_map)[1],
                                .normal = first_three(texel(material.normal_map)),
                                .occlusion = texel(material.occlusion_map)[0],
                                .emissive = first_three(texel(material.emissive_map)),
                                .normal_scale = material.normal_scale,
                                .occlusion_strength = material.occlusion_strength,
                                .place_x = step_x.place,
                                .place_y = step_y.place,
                                .texcoord_x = step_x.texcoord,
                                .texcoord_y = step_y.texcoord});
}

void RasterPicture::keep_heights(uint32_t first, uint32_t end) {
    const auto is_kept = [&](uint32_t texel) { return texel >= first && texel < end; };
    for (uint32_t i = 0; i < map_.size(); ++i)
        if (!is_kept(i % frame.map_size) || !is_kept(i / frame.map_size)) map_[i] = 0;
    const uint32_t side = raster::cells_of_map(frame.map_size), cell = 1u << raster::kCellShift;
    const auto may_read = [&](uint32_t i) { return i * cell < end && (i + 1) * cell + 3 > first; };
    for (uint32_t i = 0; i < side * side; ++i) casters_.push_back(may_read(i % side) && may_read(i / side) ? 1 : 0);
    frame.casters = casters_.data();
}

Vec3<double> RasterPicture::expected(uint32_t x, uint32_t y) const {
    Vec3<double> sum;
    for (uint32_t i = 0; i < frame.sample_count; ++i)
        sum = sum + shaded(shown_[(size_t{y} * frame.width + x) * frame.sample_count + i], x, y);
    return sum * (1.0 / frame.sample_count);
}

std::vector<uint8_t> RasterPicture::resolved(NativeIsa isa, uint32_t rows_each) const {
    return written(frame, &raster::Frame::pixels, size_t{frame.width} * frame.height * 4, isa,
                   [&](const raster::Kernel& kernel, const raster::Frame& into, std::byte* scratch) {
                       for (uint32_t row = 0; row < frame.height; row += rows_each)
                           kernel.resolve(into, row, std::min(row + rows_each, frame.height), scratch);
                   });
}

std::vector<uint64_t> RasterPicture::drawn_picture(NativeIsa isa) const {
    return written(frame, &raster::Frame::samples, samples_.size(), isa,
                   [&](const raster::Kernel& kernel, const raster::Frame& into, std::byte* scratch) {
                       kernel.draw_picture(into, {0, 0, frame.width, frame.height}, false, scratch);
                   });
}

std::vector<float> RasterPicture::drawn_map(NativeIsa isa) const {
    return written(frame, &raster::Frame::map, map_.size(), isa,
                   [&](const raster::Kernel& kernel, const raster::Frame& into, std::byte* scratch) {
                       kernel.draw_map(into, {0, 0, frame.map_size, frame.map_size}, false, scratch);
                   });
}

void RasterPicture::expect_resolved() {
    for (const NativeIsa isa : native_isas()) {
        const std::vector<uint8_t> rgba = resolved(isa, frame.height);
        double worst = 0;
        for (uint32_t y = 0; y < frame.height; ++y)
            for (uint32_t x = 0; x < frame.width; ++x) {
                const Vec3<double> linear = expected(x, y);
                const uint8_t* const p = &rgba[(size_t{y} * frame.width + x) * 4];
                const double off = std::max({std::abs(p[0] - encoded(linear.x)), std::abs(p[1] - encoded(linear.y)),
                                             std::abs(p[2] - encoded(linear.z))});
                ASSERT_LE(off, 0.7) << name_of(isa) << " at " << x << ", " << y << ": " << int{p[0]} << " " << int{p[1]}
                                    << " " << int{p[2]} << ", expected " << encoded(linear.x) << " "
                                    << encoded(linear.y) << " " << encoded(linear.z);
                ASSERT_EQ(p[3], 255);
                worst = std::max(worst, off);
            }
        std::printf("%-8s %.2f of 255\n", name_of(isa).data(), worst);
        EXPECT_EQ(resolved(isa, 1), rgba) << name_of(isa) << ", row by row";
    }
}

Picture noise(uint32_t width, uint32_t height, uint64_t seed) {
    Picture picture{.width = width, .height = height};
    Random random(seed);
    for (uint32_t i = 0; i < width * height * 4; ++i) picture.rgba.push_back(static_cast<uint8_t>(random.below(256)));
    return picture;
}

namespace {

// Vulkan 1.3, 16.6.2.
int wrapped(double place, int count, raster::Wrap wrap) {
    const auto i = static_cast<int>(place);
    const auto modulo = [](int a, int b) { return (a % b + b) % b; };
    if (wrap == raster::Wrap::kRepeat) return modulo(i, count);
    if (wrap == raster::Wrap::kClamp) return std::clamp(i, 0, count - 1);
    const int there = modulo(i, 2 * count);
    return there < count ? there : 2 * count - 1 - there;
}

}  // namespace

std::array<double, 4> sampled_reference(const raster::Texture& texture, const raster::Sampling& sampling,
                                        const std::array<double, 2>& texcoord, const std::array<double, 2>& step_x,
                                        const std::array<double, 2>& step_y) {
    const auto texels = [&](const std::array<double, 2>& step) {
        return std::hypot(step[0] * texture.width, step[1] * texture.height);
    };
    const double mip = std::clamp(std::log2(std::max(texels(step_x), texels(step_y))), 0.0, texture.mip_count - 1.0);
    std::array<double, 4> sum{};
    for (const auto& [level, of_mip] : {std::pair(std::floor(mip), 1 - (mip - std::floor(mip))),
                                        std::pair(std::floor(mip) + 1, mip - std::floor(mip))}) {
        if (of_mip == 0) continue;
        const auto number = static_cast<uint32_t>(level);
        const int width = std::max(static_cast<int>(texture.width >> number), 1),
                  height = std::max(static_cast<int>(texture.height >> number), 1);
        double x = texcoord[0] * width - 0.5, y = texcoord[1] * height - 0.5;
        if (sampling.is_nearest && mip == 0) {
            x = std::floor(x + 0.5);
            y = std::floor(y + 0.5);
        }
        for (int i = 0; i < 4; ++i) {
            const double column = std::floor(x) + i % 2, row = std::floor(y) + i / 2;
            const double weight = (1 - std::abs(x - column)) * (1 - std::abs(y - row));
            const uint64_t texel = texture.texels[texture.mip_begins[number] +
                                                  static_cast<uint32_t>(wrapped(row, height, sampling.wrap_v) * width +
                                                                        wrapped(column, width, sampling.wrap_u))];
            for (size_t channel = 0; channel < 4; ++channel)
                sum[channel] += of_mip * weight * static_cast<double>(texel >> (16 * channel) & 0xFFFF) / 65535;
        }
    }
    return sum;
}

}  // namespace throng::test
