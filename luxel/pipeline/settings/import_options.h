// Options for reading a scene's file, for every command that reads one.
#pragma once

#include "luxel/import/import.h"
#include "luxel/pipeline/settings/option.h"

namespace luxel::pipeline {

/// --smooth-normals, --up, --unit, --search-path, --trust-paths, --any-format.
Options<import::ImportParams> import_options();

}  // namespace luxel::pipeline
