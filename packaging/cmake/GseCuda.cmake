# gse_cuda_text(TARGET kernels.cu reader.cpp): compiles CUDA kernels with clang, without a CUDA toolkit, to
# PTX text that reader.cpp includes as GSE_CUDA_TEXT. Where no clang can, the build goes on without CUDA.
find_program(GSE_CLANG NAMES clang++ clang++-14 clang++-15 clang++-16 clang++-17 clang++-18 clang++-19)
# PTX 6.0 (shuffles and votes with a mask) for compute capability 6.0: drivers translate it for newer devices.
# No fusing of what the source does not fuse: depths must be those of the processor.
set(GSE_CUDA_FLAGS -x cuda --cuda-device-only --cuda-gpu-arch=sm_60 -Xclang -target-feature -Xclang +ptx60
  -nocudainc -nocudalib
  -Wno-unknown-cuda-version -std=c++20 -O3 -ffp-contract=off)
set(GSE_CUDA_PROBE ${CMAKE_BINARY_DIR}/generated/cuda_probe)
set(GSE_CUDA FALSE)
if(GSE_CLANG)
  file(WRITE ${GSE_CUDA_PROBE}.cu
    "extern \"C\" __attribute__((global)) void probe(int* to) { *to = __nvvm_bar0_or(1); }\n")
  execute_process(COMMAND ${GSE_CLANG} ${GSE_CUDA_FLAGS} -S -o ${GSE_CUDA_PROBE}.ptx ${GSE_CUDA_PROBE}.cu
    RESULT_VARIABLE failed OUTPUT_QUIET ERROR_QUIET)
  if(failed EQUAL 0)
    set(GSE_CUDA TRUE)
  endif()
endif()
if(NOT GSE_CUDA)
  message(STATUS "Without CUDA: no clang++ that compiles for it was found")
endif()

function(gse_cuda_text target kernels reader)
  if(NOT GSE_CUDA)
    return()
  endif()
  set(folder ${CMAKE_BINARY_DIR}/generated/cuda)
  file(MAKE_DIRECTORY ${folder})
  get_filename_component(name ${kernels} NAME_WE)
  set(output ${folder}/${name}.h)
  file(GLOB read_by_it CONFIGURE_DEPENDS ${CMAKE_CURRENT_SOURCE_DIR}/*.inl ${CMAKE_CURRENT_SOURCE_DIR}/*.h
    ${CMAKE_CURRENT_SOURCE_DIR}/cuda/*.inl ${CMAKE_CURRENT_SOURCE_DIR}/cuda/*.h)
  set(wrap ${CMAKE_SOURCE_DIR}/packaging/cmake/WrapKernels.cmake)
  add_custom_command(OUTPUT ${output}
    COMMAND ${GSE_CLANG} ${GSE_CUDA_FLAGS} -I${CMAKE_SOURCE_DIR} -S -o ${output}.ptx
      ${CMAKE_CURRENT_SOURCE_DIR}/${kernels}
    COMMAND ${CMAKE_COMMAND} -DINPUT=${output}.ptx -DOUTPUT=${output} -P ${wrap}
    DEPENDS ${CMAKE_CURRENT_SOURCE_DIR}/${kernels} ${read_by_it} ${wrap}
    COMMENT "CUDA ${kernels}" VERBATIM)
  target_sources(${target} PRIVATE ${output})
  set_source_files_properties(${reader} PROPERTIES
    COMPILE_DEFINITIONS "GSE_CUDA_TEXT=\"${output}\"" OBJECT_DEPENDS ${output})
endfunction()
