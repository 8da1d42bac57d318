// The program speaks of the engine's runs and windows by their own names.
#pragma once

namespace gse::pipeline {}
namespace gse::window {}

namespace gse::app {

using namespace pipeline;
using namespace window;

}  // namespace gse::app
