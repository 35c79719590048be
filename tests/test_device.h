// The device of the tests: validated, and shared by all tests of the process.
#pragma once

#include "tests/shared.h"

#include <throng/device.h>

#include <gtest/gtest.h>

#include <string_view>

namespace throng {

// THRONG_DEVICE selects it (as --device does); THRONG_VALIDATION is off, standard, synchronization (the default) or
// gpu-assisted. A message of the validation layer fails the test during which it came.
Device& test_device();
// Whether the same formula has the same bits in every kernel, natively too. Compilers of GPUs may contract it to other
// fused operations in each kernel.
bool rounds_like_the_cpu();

// The same device once more, whose limits a test may lower to pretend that it is smaller; not validated.
Device another_device();
// Whether it has this scan method: a device without Vulkan has few.
bool has_scan(std::string_view method);
// One that dispatches no more workgroups than these (or its own): crowds fall into batches.
Device device_of_workgroups(uint32_t most_workgroups);

}  // namespace throng
