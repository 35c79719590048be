// How an instance shows a section. Also compiled as C++ (gpu/glsl.h). The includer declares `InstanceLook
// instance_looks[]` and `SectionLook section_looks[]` ([outfit][section]).
#include "look/look_io.h"

SectionLook look_of_section(uint instance, uint section, uint section_count) {
    return section_looks[instance_looks[instance].outfit * section_count + section];
}

// The factor of the base colour.
vec3 look_color(uint instance, SectionLook look) {
    const InstanceLook of = instance_looks[instance];
    return vec3(look.red, look.green, look.blue) * mix(vec3(1), vec3(of.red, of.green, of.blue), look.tint);
}
