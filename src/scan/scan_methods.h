// The rows of the table; each is defined in src/scan/<method>.cpp.
#pragma once

#include "scan/scan_table.h"

namespace throng {

ScanMethod gateau2012_walk();
ScanMethod kandar2024_leaves();
ScanMethod doubling();
ScanMethod blocks64();
ScanMethod compressed();
ScanMethod levels();
ScanMethod serial();
ScanMethod serial_quaternion();
ScanMethod serial_transposed();
ScanMethod fragments();
ScanMethod subgroup();
ScanMethod subgroup_quaternion();

}  // namespace throng
