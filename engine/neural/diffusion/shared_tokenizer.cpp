// The one file of the networks that depends on where the checkout is.
#include "engine/neural/diffusion/shared_tokenizer.h"

#include <array>
#include <cstdlib>

#include "engine/base/assets.h"
#include "engine/base/error.h"
#include "engine/neural/api/tokenizer_json.h"

namespace gse::neural {

namespace fs = std::filesystem;

fs::path find_tokenizer(const fs::path& beside) {
    const char* assets = std::getenv("GSE_ASSETS");
    const std::array<fs::path, 3> candidates{
        beside / "tokenizer", beside,
        (assets != nullptr ? fs::path(assets) : assets_folder(GSE_ASSETS)) / "tokenizer"};
    for (const auto& candidate : candidates)
        if (has_tokenizer(candidate)) return candidate;
    throw Error(ErrorCode::NotFound, "a single-file checkpoint has no tokenizer and none was found",
                "put CLIP's merges.txt or tokenizer.json into a folder named tokenizer beside it",
                candidates[0]);
}

}  // namespace gse::neural
