#include "import/readers.h"
namespace luxel::import {
Status check_extension(const SourceFile&) { return {}; }
Result<Imported> read_with_assimp(const SourceFile& source) {
  return fail(ErrorCode::unsupported, "{}: not yet", source.name);
}
}  // namespace luxel::import
