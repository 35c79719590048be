// Which instances are there, of groups in which they come and go. `birth`, of the push constants: what the table holds
// for those that were born in this update; 0: all are there, always.
#include "gpu/table.glsl"

TABLE_OF_WORDS(kBirthsBuffer, births);

bool is_there(uint instance, uint birth) { return birth == 0 || WORD_AT(births, instance) != 0; }
bool is_newborn(uint instance, uint birth) { return birth != 0 && WORD_AT(births, instance) == birth; }
