// The module _luxel, which luxel/__init__.py makes the package of.
#include "bindings/python/work.h"
#include "luxel/pipeline/settings/version.h"

PYBIND11_MODULE(_luxel, module) {
  using namespace luxel::python;
  module.attr("__version__") = std::string(luxel::pipeline::kVersion);
  add_error(module);
  add_stop_at_exit(module);
  add_scene(module);
  add_trace(module);
  add_bake(module);
  add_factors(module);
  add_relighter(module);
  add_compare(module);
}
