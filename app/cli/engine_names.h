// The program speaks of the engine's runs, benches and windows by their own names.
#pragma once

namespace gse::pipeline {}
namespace gse::bench {}
namespace gse::training {}
namespace gse::window {}

namespace gse::app {

using namespace pipeline;
using namespace bench;
using namespace training;
using namespace window;

}  // namespace gse::app
