// Fuzz target: the reader of what torch.save writes.
#include "engine/neural/weights/torch_pickle.h"
#include "tests/fuzz/fuzz_helpers.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace gse;
    return fuzz::exercise([&] {
        const std::string pickle(reinterpret_cast<const char*>(data), size);
        for (const auto& [name, tensor] : neural::read_tensor_pickle(pickle, "fuzz.pt")) {
            GSE_CHECK(tensor.shape.size() == tensor.strides.size() && tensor.offset >= 0);
            std::int64_t last = tensor.offset;
            std::int64_t numbers = 1;
            bool empty = false;
            for (std::size_t i = 0; i < tensor.shape.size(); ++i) {
                empty = empty || tensor.shape[i] == 0;
                if (!empty) numbers *= tensor.shape[i];
                last += (tensor.shape[i] - 1) * tensor.strides[i];
            }
            GSE_CHECK(empty || (last < tensor.elements && numbers <= tensor.elements));
        }
    });
}
