// Tables for the tests of one stage.
#pragma once

#include "gpu/upload.h"
#include "tests/test_device.h"

namespace throng::test {

// Uploads what `make` gives its Uploads.
template <class Make>
void upload_now(const Make& make) {
    Uploads uploads(test_device().gpu());
    make(uploads);
    uploads.finish();
}

}  // namespace throng::test
