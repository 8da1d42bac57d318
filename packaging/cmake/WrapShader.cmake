# Puts glslang's array into the project's namespace.
file(READ ${INPUT} text)
string(FIND "${text}" "const uint32_t" begin)
string(SUBSTRING "${text}" ${begin} -1 text)
string(REPLACE "const uint32_t" "inline constexpr std::uint32_t" text "${text}")
file(WRITE ${OUTPUT}
  "// SPIR-V of shaders/${FILE}.\n#pragma once\n#include <cstdint>\nnamespace gse::shaders {\n${text}}\n")
