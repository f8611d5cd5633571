// The user's errors: bad input, bad options. Programmer's errors are assertions.
#pragma once

#include <fmt/format.h>

#include <stdexcept>
#include <string>
#include <string_view>

namespace boxgrasp {

// Bad input or configuration. The message names the value, the place and the remedy.
class InputError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

// Checks one field of an options struct; throws InputError with the field's name, its value and the bound it
// breaks.
template <typename T>
void requireOption(bool holds, std::string_view field, const T& value, std::string_view bound) {
  if (!holds) throw InputError(fmt::format("option '{}' is {}, but must be {}", field, value, bound));
}

}  // namespace boxgrasp
