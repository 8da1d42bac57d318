// Form of the OpenAI protocol's picture edits, and its differences between products.
#pragma once

#include <string>
#include <vector>

#include "engine/remote/api/image_server.h"
#include "engine/remote/http/http_types.h"
#include "engine/remote/protocols/server_loras.h"

namespace gse::remote {

/// Programs that speak the OpenAI protocol. They differ in names of fields, masks, and seeds.
enum class OpenAiProduct { SdServer, Vllm, OpenAi, Other };

std::string openai_product_name(OpenAiProduct product);

/// Parts of a request that are an artist's own.
struct OpenAiExtras {
    std::vector<ChosenLora> loras = {};  // in sd-server's form, else in vLLM-Omni's
    std::vector<ServerOption> options = {};
};

/// Parts of POST images/edits. `model` is left away where it is empty; `extras` are checked.
std::vector<HttpPart> openai_parts(const RedrawOrder& order, OpenAiProduct product, const std::string& model,
                                   const OpenAiExtras& extras = {});

}  // namespace gse::remote
