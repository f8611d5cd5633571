// Files that are whole after a crash of the program or the machine.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>

namespace boxgrasp {

// Who may read a file: everybody, or its owner alone.
enum class Readers { everybody, owner };

// Puts the bytes in place of the file in one step: a temporary file beside it, synced, renamed, and the
// folder synced. Whenever the machine stops, the file is the old one or the new one, and the new one after
// the return. Throws InputError with the step, the cause and the remedy; then what was there before is
// untouched. Temporary files that a crash leaves behind are named "<file>.XXXXXX".
void writeDurably(const std::filesystem::path& file, std::string_view bytes,
                  Readers readers = Readers::everybody);

// The bytes of a regular file of at most `most` bytes. Throws InputError with the cause and the remedy.
std::string readWhole(const std::filesystem::path& file, std::uintmax_t most);

}  // namespace boxgrasp
