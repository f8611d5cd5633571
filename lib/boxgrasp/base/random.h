// Random numbers that are the same with every standard library: std::mt19937_64 is specified bit for bit, the
// standard's distributions are not.
#pragma once

#include <cmath>
#include <cstdint>
#include <numbers>
#include <random>

namespace boxgrasp {

// Uniform in [0, 1), in steps of 2^-53.
inline double uniform(std::mt19937_64& random) { return static_cast<double>(random() >> 11) * 0x1p-53; }

// Uniform in [low, high).
inline double uniform(std::mt19937_64& random, double low, double high) {
  return low + (high - low) * uniform(random);
}

// Uniform in {0, ..., n - 1}. Pre: n > 0. Uneven by less than n / 2^64.
inline std::uint64_t uniformIndex(std::mt19937_64& random, std::uint64_t n) { return random() % n; }

// Normal with mean 0 and standard deviation 1 (Box-Muller; takes two numbers from the generator).
inline double normal(std::mt19937_64& random) {
  const double radius = std::sqrt(-2.0 * std::log(1.0 - uniform(random)));
  return radius * std::cos(2.0 * std::numbers::pi * uniform(random));
}

}  // namespace boxgrasp
