// character_covering: its blended material, lit.
#define COVERS
#include "draw/character.glsl"
