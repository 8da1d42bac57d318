# Makes a string of the program out of PTX text.
file(READ ${INPUT} text)
file(WRITE ${OUTPUT}
  "// PTX text of the CUDA kernels.\n#pragma once\nnamespace gse::raster::cuda {\n"
  "inline constexpr const char* KernelText = R\"ptx(${text})ptx\";\n}\n")
