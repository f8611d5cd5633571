// The activation function of the hidden layers.
#pragma once

#include <cstddef>

namespace boxgrasp {

// Replaces each of n values x by tanh(x), absolute error below 4e-16, +-1 beyond |x| = 20; NaN stays NaN. Our
// own, because the C library's result differs between its versions and between processors: a score must not.
void tanhInPlace(double* values, std::size_t n);

}  // namespace boxgrasp
