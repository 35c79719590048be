// Which instances exist, in groups where they come and go. `birth`, a push constant: what the table holds for instances
// born in this update; 0: all exist, always.
#include "gpu/table.glsl"

TABLE_OF_WORDS(kBirthsBuffer, births);

bool is_there(uint instance, uint birth) { return birth == 0 || WORD_AT(births, instance) != 0; }
bool is_newborn(uint instance, uint birth) { return birth != 0 && WORD_AT(births, instance) == birth; }
