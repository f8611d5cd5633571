// What can go wrong with the file of a store.
#pragma once

#include "boxgrasp/base/error.h"

namespace boxgrasp {

// A full disk, an error of the disk, a file that is damaged, foreign, too new or in use by another process.
// The message names the file, the cause and the remedy.
class StoreError : public InputError {
 public:
  using InputError::InputError;
};

}  // namespace boxgrasp
