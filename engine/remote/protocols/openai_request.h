// Form of the OpenAI protocol's picture edits, and its differences between products.
#pragma once

#include <string>
#include <vector>

#include "engine/remote/api/image_server.h"
#include "engine/remote/http/http_types.h"

namespace gse::remote {

/// Programs that speak the OpenAI protocol. They differ in names of fields, masks, and seeds.
enum class OpenAiProduct { SdServer, Vllm, OpenAi, Other };

std::string openai_product_name(OpenAiProduct product);

/// Parts of POST images/edits. `model` is left away where it is empty.
std::vector<HttpPart> openai_parts(const RedrawOrder& order, OpenAiProduct product, const std::string& model);

}  // namespace gse::remote
