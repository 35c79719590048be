// Which instances exist, in groups where they come and go: those whose entry in the table is not 0. `birth`, a push
// constant, is the entry of instances born in this update; if it is 0, all instances always exist.
// Kernels that need not know about births have a constant in its place, kVaries.
#include "gpu/table.glsl"

TABLE_OF_WORDS(kBirthsBuffer, births);

bool is_free(uint instance) { return WORD_AT(births, instance) == 0; }
bool is_there(uint instance, uint birth) { return birth == 0 || WORD_AT(births, instance) != 0; }
bool is_newborn(uint instance, uint birth) { return birth != 0 && WORD_AT(births, instance) == birth; }
