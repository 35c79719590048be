// The device of the tests: validated, and shared by all tests in the process.
#pragma once

#include "tests/shared.h"

#include <throng/device.h>

#include <gtest/gtest.h>

#include <string_view>

namespace throng {

// THRONG_DEVICE selects the device (like --device). THRONG_VALIDATION is off, standard, synchronization (the default)
// or gpu-assisted. A validation message fails the test that is running.
Device& test_device();
// Whether the same formula gives the same bits in every kernel, including native ones. GPU compilers may contract it
// into different fused operations in each kernel.
bool rounds_like_the_cpu();

// Another Device of the same hardware, not validated. Tests may lower its limits to simulate a smaller one.
Device another_device();
// Whether the device has this scan method. A device without Vulkan has few.
bool has_scan(std::string_view method);
// A device that dispatches at most this many workgroups (or its own limit), so that crowds are split into batches.
Device device_of_workgroups(uint32_t max_workgroups);

}  // namespace throng
