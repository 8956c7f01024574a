// The options of the form-factor matrix, which `luxel relight` has, too.
#pragma once

#include "luxel/pipeline/settings/option.h"
#include "luxel/solve/matrix/matrix.h"

namespace luxel::pipeline {

/// The rows of the solver's parameters that a user chooses: --patches, --rays.
Options<matrix::MatrixParams> matrix_options();

}  // namespace luxel::pipeline
