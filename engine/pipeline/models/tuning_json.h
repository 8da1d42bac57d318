// The report of a tuning as JSON.
#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <string_view>

#include "engine/neural/api/dreambooth_parameters.h"

namespace gse::pipeline {

nlohmann::ordered_json tuning_to_json(const neural::TuneReport& report);
/// Nothing where the text is something else.
std::optional<neural::TuneReport> tuning_from_json(std::string_view text);

}  // namespace gse::pipeline
