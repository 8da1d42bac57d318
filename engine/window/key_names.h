// Keys by what is written on them.
#pragma once

namespace gse::window {

/// GLFW names a key by its place on an American keyboard. `key` where `name`, what glfwGetKeyName() says of
/// it (may be null), is no letter of A to Z and no mark that such a keyboard has a key for; else the key of
/// that letter or mark: Ctrl + Z is where Z is written.
int written_key(int key, const char* name);

}  // namespace gse::window
