#include <throng/version.h>

#define THRONG_TEXT_OF(number) #number
#define THRONG_VERSION_TEXT(major, minor, patch) \
    THRONG_TEXT_OF(major) "." THRONG_TEXT_OF(minor) "." THRONG_TEXT_OF(patch)

namespace throng {

const char* version() { return THRONG_VERSION_TEXT(THRONG_VERSION_MAJOR, THRONG_VERSION_MINOR, THRONG_VERSION_PATCH); }

}  // namespace throng
