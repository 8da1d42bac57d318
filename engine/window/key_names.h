// Keys by the letters written on them.
#pragma once

namespace gse::window {

/// Key of the letter or mark `name`, the result of glfwGetKeyName() (may be null): Ctrl + Z is the key
/// labelled Z. GLFW names a key by its place on an American keyboard. Returns `key` when `name` is no letter
/// of A to Z and no mark that such a keyboard has.
int written_key(int key, const char* name);

}  // namespace gse::window
