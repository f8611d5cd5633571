// What an action complains of.
#pragma once

#include <string>

#include "boxgrasp/base/error.h"

namespace boxgrasp::test {

// The message of the InputError that the action throws; "accepted" where it throws none.
template <typename Action>
std::string errorOf(const Action& action) {
  try {
    action();
  } catch (const InputError& error) {
    return error.what();
  }
  return "accepted";
}

}  // namespace boxgrasp::test
