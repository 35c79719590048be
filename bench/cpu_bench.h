// `throng bench cpu`: whole updates by the native engine, checked against the reference and then timed in turns with a
// streamed fill of the same bytes. Needs no device.
#pragma once

#include "bench/record.h"
#include "bench/rounds.h"
#include "native/native.h"

#include <throng/playback.h>

namespace throng::bench {

struct CpuVariant {
    std::string name;
    const Character* character = nullptr;
    uint32_t clips = 2;
    bool layers = false;  // two clips, below two of a masked layer, below an additive one
};

struct CpuCase {
    std::string configuration;
    uint32_t characters = 0;
    std::vector<CpuVariant> variants;
    std::vector<NativeIsa> isas;
    std::vector<uint32_t> threads;
    uint32_t samples = 15;
    uint64_t seed = 1;
};

// The same asset with each joint's translation animated too.
Asset with_moving_translations(const Asset& asset);

// A record for each instruction set, variant and number of threads (bench/README.md lists the fields). Wrong results
// are not timed, and their records say so.
std::vector<Json> measure_cpu(const CpuCase& cpu_case, const Progress& progress);

}  // namespace throng::bench
