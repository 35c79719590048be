// Poses of real characters, computed by two other programs (shared/goldens/README.md), and how far other results are
// from them.
#pragma once

#include "tests/shared.h"

#include <throng/throng.h>

#include <gtest/gtest.h>
#include <nlohmann/json_fwd.hpp>

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

namespace throng::test {

inline constexpr double kGoldenBound = 2e-5;  // of the character's size

struct Golden {
    std::filesystem::path file;
    Character character;
    std::shared_ptr<const nlohmann::json> data;
    std::vector<Playback> playbacks;  // one per answer
    double size = 0;
};

std::vector<Golden> load_goldens();

struct Computed {
    std::vector<AffineT<double>> model, skin;
    std::vector<Vec3<double>> positions;
};

// Largest errors of an answer as fractions of the size, and how many numbers were compared.
struct Comparison {
    double joint = 0, skin = 0, vertex = 0;
    uint64_t matrices = 0, vertices = 0;
};

// Compares with one answer, by its number, and updates `worst`.
void compare(const Golden& golden, size_t answer, const Computed& computed, Comparison& worst);

// As fractions of the size. With compressed clips or rounded matrices, only points are guaranteed to stay close.
struct GoldenBounds {
    double matrix = kGoldenBound, vertex = kGoldenBound;
};

void report(const Golden& golden, const std::string& method, const Comparison& worst, const GoldenBounds& bounds = {});

}  // namespace throng::test
