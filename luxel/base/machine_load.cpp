#include "luxel/base/machine_load.h"

#include <fstream>

namespace luxel {
inline namespace base {

double machine_load() {
  std::ifstream in("/proc/thread-self/schedstat");  // Linux: ns on a processor, ns that waited
  double had = 0, waited = 0;
  if (!(in >> had >> waited) || !(had > 0)) return 1;
  return 1 + waited / had;
}

}  // namespace base
}  // namespace luxel
