# Options, warnings, sanitizers and the third-party packages every module may ask for.
option(GSE_TESTS "Build the tests" ON)
option(GSE_OPENCV "Use OpenCV (image and video files, GrabCut)" ON)
option(GSE_NEURAL "Build the networks (needs libtorch)" ON)
option(GSE_REMOTE "Build the client of image servers (needs libcurl)" ON)
option(GSE_WINDOW "Build the window (needs Vulkan, GLFW, Dear ImGui)" ON)
option(GSE_FUZZ "Build the fuzz targets with libFuzzer (clang)" OFF)
set(GSE_SANITIZE "" CACHE STRING "Sanitizers for -fsanitize=, for example address,undefined or thread")

set(CMAKE_CXX_STANDARD 20)
set(CMAKE_CXX_STANDARD_REQUIRED ON)
set(CMAKE_CXX_EXTENSIONS OFF)
set(CMAKE_POSITION_INDEPENDENT_CODE ON)
if(NOT CMAKE_BUILD_TYPE)
  set(CMAKE_BUILD_TYPE Release CACHE STRING "" FORCE)
endif()

# Several sources in one: most of a compile is reading the same headers. Off in the preset for changing one
# file at a time.
option(GSE_UNITY "Compile the sources of a library in groups" ON)
set(CMAKE_UNITY_BUILD ${GSE_UNITY})
set(CMAKE_UNITY_BUILD_BATCH_SIZE 10)

find_program(GSE_CCACHE ccache)
if(GSE_CCACHE)
  set(CMAKE_CXX_COMPILER_LAUNCHER ${GSE_CCACHE})
endif()

# -ffp-contract=off: the plain and the fast rasterizer must not differ by where the compiler fuses; fast code
# asks for FMA by intrinsic.
add_library(gse_flags INTERFACE)
target_compile_options(gse_flags INTERFACE -Wall -Wextra -Wshadow -Wno-unused-parameter -ffp-contract=off)
target_include_directories(gse_flags INTERFACE ${CMAKE_SOURCE_DIR})
if(GSE_SANITIZE)
  target_compile_options(gse_flags INTERFACE -fsanitize=${GSE_SANITIZE} -fno-omit-frame-pointer
    -fno-sanitize-recover=all)
  target_link_options(gse_flags INTERFACE -fsanitize=${GSE_SANITIZE})
  target_compile_definitions(gse_flags INTERFACE GSE_SANITIZED=1)
endif()
if(GSE_FUZZ)
  target_compile_options(gse_flags INTERFACE -fsanitize=fuzzer-no-link,address,undefined
    -fno-sanitize-recover=all)
  target_link_options(gse_flags INTERFACE -fsanitize=address,undefined)
  target_compile_definitions(gse_flags INTERFACE GSE_SANITIZED=1)
endif()

find_package(Threads REQUIRED)
find_package(fmt REQUIRED)
find_package(spdlog REQUIRED)
find_package(nlohmann_json REQUIRED)
find_package(glm REQUIRED)
find_package(PkgConfig REQUIRED)
if(GSE_OPENCV)
  # Debian keeps OpenCVConfig.cmake in libopencv-dev, which pulls in hundreds of packages; the four libraries
  # do.
  find_path(GSE_OPENCV_INCLUDE opencv2/core.hpp PATH_SUFFIXES opencv4 REQUIRED)
  add_library(gse_opencv INTERFACE)
  target_include_directories(gse_opencv SYSTEM INTERFACE ${GSE_OPENCV_INCLUDE})
  target_compile_definitions(gse_opencv INTERFACE GSE_HAVE_OPENCV=1)
  foreach(part core imgproc imgcodecs videoio)
    find_library(GSE_OPENCV_${part} opencv_${part} REQUIRED)
  endforeach()
  target_link_libraries(gse_opencv INTERFACE ${GSE_OPENCV_core} ${GSE_OPENCV_imgproc})
  # Files: what these bring along is only loaded when one is read or a film is written.
  add_library(gse_opencv_files INTERFACE)
  target_link_libraries(gse_opencv_files INTERFACE gse_opencv ${GSE_OPENCV_imgcodecs} ${GSE_OPENCV_videoio})
endif()
if(GSE_NEURAL)
  # Here and not in engine/neural: imported targets are only visible below the folder that asks for them.
  find_package(Torch REQUIRED)
endif()
