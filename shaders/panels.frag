// Panels: vertex colour times texture.
#version 450
layout(location = 0) in vec4 colour;
layout(location = 1) in vec2 coordinate;
layout(set = 0, binding = 0) uniform sampler2D picture;
layout(location = 0) out vec4 result;

void main() { result = colour * texture(picture, coordinate); }
