// All bodies, in the order of use; included inside a namespace, after grid.h and arguments.h.
// clang-format off
#include "engine/raster/cuda/kernel_lanes.inl"
#include "engine/raster/cuda/kernel_sort.inl"
#include "engine/raster/cuda/kernel_rows.inl"
#include "engine/raster/cuda/kernel_pixels.inl"
#include "engine/raster/cuda/kernel_chain.inl"
// clang-format on
