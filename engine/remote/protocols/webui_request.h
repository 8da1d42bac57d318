// Body of the WebUI protocol's img2img, and its differences between products.
#pragma once

#include <string>

#include <nlohmann/json.hpp>

#include "engine/remote/api/image_server.h"

namespace gse::remote {

/// Programs that speak the WebUI protocol.
enum class WebuiProduct { A1111, Forge, SdNext, KoboldCpp, SdServer, Other };

std::string webui_product_name(WebuiProduct product);

/// Pictures that it takes beside the one to redraw.
std::size_t webui_references(WebuiProduct product);

/// True where a job has a number of ours, with which its progress is asked and it is stopped.
bool webui_has_tasks(WebuiProduct product);

/// Steps to ask, so that RedrawOrder::steps really run.
int webui_steps(WebuiProduct product, int real, double strength);

/// True where LoRAs are a list beside the prompt; elsewhere they are tags inside it.
bool webui_lists_loras(WebuiProduct product);

/// Body of POST img2img. `task` is the job's number, where the product has them.
nlohmann::json webui_body(const RedrawOrder& order, WebuiProduct product, const std::string& task);

/// Name of the model in an answer's `info`, a text that holds JSON; empty where it tells none.
std::string webui_model(const nlohmann::json& answer);

}  // namespace gse::remote
