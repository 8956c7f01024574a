// The options of the form-factor matrix, which `luxel relight` has, too.
#pragma once

#include "luxel/pipeline/settings/option.h"
#include "luxel/solve/matrix/matrix.h"

namespace luxel::pipeline {

/// Of the solver's parameters those that a user chooses: --patches, --rays.
Options<matrix::MatrixParams> matrix_options();

}  // namespace luxel::pipeline
