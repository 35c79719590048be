// character: its material, lit.
#include "draw/character.glsl"
