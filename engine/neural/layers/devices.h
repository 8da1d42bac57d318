// Devices that networks run on, and the threads they take.
#pragma once

#include <torch/torch.h>

#include <string>

namespace gse::neural {

/// The device of a name: "cpu", "cuda" or "cuda:1". Throws Error (InvalidArgument) for other names and for a
/// device that is not there.
torch::Device parse_device(const std::string& name);

/// Sets the threads inside one network operation; 0 = one per hardware thread. More threads than free cores
/// make small networks slower.
void set_threads(int count);

/// Sets the threads of OpenBLAS, which has its own beside torch's. Does nothing with another library.
void set_blas_threads(int count);
/// Sets one thread of OpenBLAS, unless a model that was loaded has set them. Suits work that callers share
/// out.
void prefer_one_blas_thread();

}  // namespace gse::neural
