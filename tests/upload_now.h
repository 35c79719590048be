// Uploads tables for tests of a single stage.
#pragma once

#include "gpu/upload.h"
#include "tests/test_device.h"

namespace throng::test {

// Calls `make` with an Uploads and submits it.
template <class Make>
void upload_now(const Make& make) {
    Uploads uploads(test_device().gpu());
    make(uploads);
    uploads.finish();
}

}  // namespace throng::test
