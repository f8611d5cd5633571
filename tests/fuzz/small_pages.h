// Stores for seeds.
#pragma once

#include <sqlite3.h>

#include "fuzz_target.h"

namespace boxgrasp::fuzz {

// Packs a store into one file of the smallest pages, so that mutations hit something.
inline void makeSmall(const std::filesystem::path& file) {
  sqlite3* handle = nullptr;
  promise(sqlite3_open(file.c_str(), &handle) == SQLITE_OK &&
          sqlite3_exec(handle, "PRAGMA journal_mode = DELETE; PRAGMA page_size = 512; VACUUM", nullptr,
                       nullptr, nullptr) == SQLITE_OK);
  sqlite3_close(handle);
}

}  // namespace boxgrasp::fuzz
