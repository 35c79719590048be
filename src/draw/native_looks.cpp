#include "draw/native_looks.h"

#include "gpu/native_text.h"
#include "look/look_io.h"

namespace throng {
namespace io {
namespace {

struct LookText : NativeText {
    explicit LookText(const NativeDispatch& of) : NativeText(of, 0, 1, 0) {}

    READONLY_BUFFER(kInstanceLooksBuffer, InstanceLook, instance_looks);
    READONLY_BUFFER(kSectionLooksBuffer, SectionLook, section_looks);

#include "look/look.glsl"
};

}  // namespace
}  // namespace io

NativeLook NativeLooks::of(uint32_t instance, uint32_t section) const {
    io::LookText text(buffers_);
    const io::SectionLook look = text.look_of_section(instance, section, section_count_);
    const io::vec3 color = text.look_color(instance, look);
    return {look.material, {color.x, color.y, color.z}};
}

}  // namespace throng
