// Panels: pixels of ImGui -> clip space.
#version 450
layout(location = 0) in vec2 position;
layout(location = 1) in vec2 coordinate;
layout(location = 2) in vec4 colour;
layout(push_constant) uniform Push { vec2 scale, offset; } push;
layout(location = 0) out vec4 out_colour;
layout(location = 1) out vec2 out_coordinate;

void main() {
    out_colour = colour;
    out_coordinate = coordinate;
    gl_Position = vec4(position * push.scale + push.offset, 0.0, 1.0);
}
