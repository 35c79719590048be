// What is uploaded with others, alone.
#pragma once

#include "gpu/upload.h"
#include "tests/test_device.h"

namespace throng::test {

// What `make` makes of its uploads, when these have finished.
template <class Make>
auto uploaded(const Make& make) {
    Uploads uploads(test_device().gpu());
    auto made = make(uploads);
    uploads.finish();
    return made;
}

}  // namespace throng::test
