// Choices of the blend passes.
layout(constant_id = 0) const uint Mode = 0;
// Depth and value are summed up only when something shows them.
layout(constant_id = 1) const uint WithDepth = 0;
layout(constant_id = 2) const uint WithValue = 0;
layout(constant_id = 3) const uint StoreDepth = 0;
layout(constant_id = 4) const uint StoreLight = 0;
#include "splat.glsl"
#include "resolve.glsl"
#include "light.glsl"
