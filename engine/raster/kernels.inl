// All kernels, in the order of use. Included inside the namespace of an instruction set after its register
// types.
// clang-format off
#include "engine/raster/kernel_geometry.inl"
#include "engine/raster/kernel_project.inl"
#include "engine/raster/kernel_bin.inl"
#include "engine/raster/kernel_blend.inl"
#include "engine/raster/kernel_backward.inl"
#include "engine/raster/kernel_gradient.inl"
#include "engine/raster/kernel_floor.inl"
// clang-format on
