// Up to what a mean may be, from some of its values.
#pragma once

#include <span>

namespace luxel::pipeline {

/// A bound that the mean of a population exceeds in about one of forty cases, from independent
/// draws. With x their mean, s their standard deviation and g their skewness it is
/// x + s / sqrt(n) (z + g (2 z^2 + 1) / (6 sqrt(n))), z = 2: the quantile of Student's statistic to
/// the second order [Hall92]. Squares of errors are skewed: a few large ones make most of
/// their mean, and draws without them show a small mean and a small s at once. No draws: 0.
double upper_mean(std::span<const double> draws);

}  // namespace luxel::pipeline
