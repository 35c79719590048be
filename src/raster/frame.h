// A picture, as the kernels of all instruction sets take it. It consists of plain numbers and pointers, so that no
// function of a header is compiled for an instruction set that a machine may not have.
//
// skin brings the vertices of each draw into world space. draw_map and draw_picture work tile by tile: they find the
// height towards the sun at each texel of the shadow map, and the triangle that each sample of the picture shows.
// resolve lights those samples.
#pragma once

#include <cstddef>
#include <cstdint>

namespace throng::raster {

// Vertices and triangles lie in blocks of this many, filled up with zeros, which have no effect.
inline constexpr uint32_t kBlock = 16;
// Vertices in world space lie in fours, each four in a cache line, since shading reads three vertices from anywhere:
// x[4], y[4], z[4], normals[4] (unit; as Vertex has them).
inline constexpr uint32_t kFour = 4, kFourFloats = 4 * kFour;
inline constexpr uint32_t kBlockFloats = kBlock / kFour * kFourFloats;

inline constexpr uint32_t kMipLimit = 16;

// Cells of the shadow map have 2^kCellShift texels each way.
inline constexpr uint32_t kCellShift = 4;
constexpr uint32_t cells_of_map(uint32_t map_size) { return (map_size + (1u << kCellShift) - 1) >> kCellShift; }

// Linear light or plain numbers, 16 bits each, red lowest.
struct Texture {
    const uint64_t* texels = nullptr;  // of all mips
    uint32_t width = 0, height = 0;
    uint32_t mip_count = 0;
    uint32_t mip_begins[kMipLimit] = {};  // among texels; each has max(width >> mip, 1) columns
};

// What a coordinate outside of 0..1 reads; numbered as TextureWrap.
enum class Wrap : uint8_t { kRepeat, kClamp, kMirror };

// How textures are read.
struct Sampling {
    bool is_nearest = false;  // reads the nearest texel where texels are larger than pixels; else mixes them
    Wrap wrap_u = Wrap::kRepeat, wrap_v = Wrap::kRepeat;
};

// As io::DrawPush and the fragment shader take it.
struct Material {
    float base_color[4] = {1, 1, 1, 1};
    float emissive[3] = {};
    float metallic = 0, roughness = 1;
    float normal_scale = 0, occlusion_strength = 0;  // 0: no such map
    float alpha_cutoff = 0;                          // of masks
    bool is_masked = false;                          // its alpha may leave out pixels
    bool is_blended = false;                         // implies is_masked: alpha is the part of samples covered
    bool is_double_sided = false;
    bool has_maps = false;  // other textures than the base colour's
    Sampling sampling{};    // of all maps
    // Null: white
    const Texture* base_color_map = nullptr;
    const Texture* metallic_roughness_map = nullptr;
    const Texture* normal_map = nullptr;
    const Texture* occlusion_map = nullptr;
    const Texture* emissive_map = nullptr;
};

// A section of a character at one level of detail, with the vertices that this level has and no others.
struct Section {
    uint32_t vertex_count = 0, triangle_count = 0;
    const uint32_t* corners[3] = {};    // [triangle_count, to a whole block], vertices of the section
    const float* bind = nullptr;        // [vertex_count, to a whole block][8]: position, 1, normal, 0; bind space
    const float* weights = nullptr;     // [vertex][influence_count], sum 1
    const uint16_t* entries = nullptr;  // [vertex][influence_count], palette entries
    uint32_t influence_count = 4;       // a multiple of 4
    const float* texcoords = nullptr;   // [vertex][2]
    const uint32_t* colors = nullptr;   // [vertex], as Vertex::color
};

// A section of an instance.
struct Draw {
    const Section* section = nullptr;
    const Material* material = nullptr;
    float* vertices = nullptr;  // [block of vertices][kBlockFloats], at a multiple of 64 bytes
    // Number of the draw's first triangle, a multiple of kIdBlock. Numbers grow in drawing order: of two triangles at
    // the same depth, the one with the lower number is seen
    uint32_t first_id = 0;
    uint32_t layer = 0;          // coverage_layer() of draw/coverage.glsl
    bool is_mirrored = false;    // by its placement: front faces wind the other way
    float size = 1;              // of the character, in the world
    float color[3] = {1, 1, 1};  // times the base colour, where Frame::has_colors
    // Written by skin: a box around all vertices, in pixels of the picture and texels of the map
    float picture_box[4] = {};  // x, y of the least corner, of the greatest
    float map_box[4] = {};
    float nearest = 0;  // the greatest depth of a vertex; 1 if one is nearer than the near plane
};

// A draw's triangles get numbers in blocks of this many.
inline constexpr uint32_t kIdBlock = 64;

// A line of some width, as two triangles in clip coordinates: corners 0 1 2 and 2 1 3.
struct Line {
    float corners[4][4];
    float color[3];  // linear
};

// io::DrawScene, number by number.
struct Scene {
    float clip_from_world[4][4], map_from_world[3][4];
    float eye[4], forward[4], right[4], down[4], to_sun[4], ground[4], fog[4], picture[4], shadow[4], map_grid[4];
    float sun_light[4], sky_light[4], bounce_light[4], horizon[4], zenith[4], ground_albedo[4];
};

struct Frame {
    Scene scene{};
    uint32_t width = 0, height = 0;
    uint32_t sample_count = 4;  // of a pixel: 1 or 4, at the same positions as in Vulkan
    uint32_t map_size = 0;      // texels of the shadow map, each way

    Draw* draws = nullptr;  // in the order of their ids
    uint32_t draw_count = 0;
    bool has_colors = false;                  // `color` of some draws may differ from 1
    uint32_t max_vertices = 0;                // of a draw
    const uint32_t* nearest_first = nullptr;  // [draw_count], draws
    const uint32_t* draw_of_ids = nullptr;    // [id / kIdBlock]
    // Drawn after the draws. Each line has two ids, from first_line_id on. The first depth_tested_count lines are
    // hidden by what is in front of them. The rest cover everything, and each of them covers those after it
    const Line* lines = nullptr;
    uint32_t line_count = 0, depth_tested_count = 0;
    uint32_t first_line_id = 0;

    // [map_size][map_size], the greatest height by map_from_world (0: none)
    float* map = nullptr;
    // [row of cells][column]: 0 only where the map is empty in the cell's texels and 3 more to the right and below.
    // Null: not known
    const uint32_t* casters = nullptr;
    // [height][width][sample_count]: the bits of the depth (0: nothing) in the high half, ~id in the low half. The
    // greatest value is seen
    uint64_t* samples = nullptr;
    const uint32_t* srgb = nullptr;  // [kSrgbSteps + 1]: 0..255, for linear values from 0 to 1
    uint8_t* pixels = nullptr;       // [height][width][4], what resolve writes: red, green, blue, 255
    bool blue_first = false;         // of pixels: blue, green, red, 255
};
inline constexpr uint32_t kSrgbSteps = 1 << 14;
// Depth of a line that covers everything; those of triangles are at most 1
inline constexpr float kOverEverything = 2;

// Pixels of the picture, or texels of the map; x1, y1: one past the last.
struct Tile {
    uint32_t x0 = 0, y0 = 0, x1 = 0, y1 = 0;
};

struct Kernel {
    // Computes placement * skin, the matrices world_from_bind. `columns`: [count][16], four floats a column; `skin`:
    // [count][12], rows of four as in Affine.
    void (*place)(const float* placement, const float* skin, uint32_t count, float* columns);
    // Fills draw.vertices, and the draw's boxes and nearest depth. `bind`: as Section::bind, and used in its place if
    // not null (morphed).
    void (*skin)(const Frame& frame, const float* columns, const float* bind, Draw& draw);
    // As skin, for vertices that have been skinned already: world space, [vertex_count, to a whole block][8] as
    // Section::bind.
    void (*keep)(const Frame& frame, const float* world, Draw& draw);
    // Scratch memory that a thread needs for one of the following calls.
    size_t (*scratch_bytes)(const Frame& frame);
    // Clears the tile of the map, or of the picture, unless `is_clear`, then draws what lies in it. Returns whether the
    // tile is clear afterwards. `scratch`: at a multiple of 64.
    bool (*draw_map)(const Frame& frame, const Tile& tile, bool is_clear, std::byte* scratch);
    bool (*draw_picture)(const Frame& frame, const Tile& tile, bool is_clear, std::byte* scratch);
    // Writes these rows of pixels; all tiles must be finished.
    void (*resolve)(const Frame& frame, uint32_t first_row, uint32_t end_row, std::byte* scratch);
};

// One for each instruction set that this was compiled for.
#if defined(__x86_64__)
const Kernel& kernel_sse2();
const Kernel& kernel_avx2();
const Kernel& kernel_avx512();
#elif defined(__aarch64__)
const Kernel& kernel_neon();
#endif

}  // namespace throng::raster
