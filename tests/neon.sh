#!/bin/sh
# neon.sh [GOOGLETEST'S OPTIONS]: compiles the native engine's tests against the reference for 64-bit ARM and runs them
# in an emulator, which takes some minutes. Needs Debian's g++-aarch64-linux-gnu, qemu-user and googletest (its source).
set -eu
cd "$(dirname "$0")/.."
cmake -S tests/neon -B build/neon -G Ninja -DCMAKE_BUILD_TYPE=Release -DCMAKE_SYSTEM_NAME=Linux \
  -DCMAKE_SYSTEM_PROCESSOR=aarch64 -DCMAKE_C_COMPILER=aarch64-linux-gnu-gcc -DCMAKE_CXX_COMPILER=aarch64-linux-gnu-g++ \
  >/dev/null
cmake --build build/neon
exec qemu-aarch64 build/neon/neon_tests "$@"
