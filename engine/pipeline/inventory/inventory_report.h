// The list of models as a table and as JSON.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "engine/pipeline/inventory/model_inventory.h"

namespace gse::pipeline {

/// {"folders": [{"path", "program", "found"}], "models": [{"path", "kind", "bytes", "use", "option",
/// "reason", "server_family", "broken"}], "complete"}; "use" is "here", "server" or "none".
nlohmann::ordered_json inventory_json(const ModelInventory& inventory);

/// A table with one heading per folder, fit for a terminal of 100 columns; says where it looked when nothing
/// was found. Text from files is escaped.
std::string inventory_text(const ModelInventory& inventory);

}  // namespace gse::pipeline
