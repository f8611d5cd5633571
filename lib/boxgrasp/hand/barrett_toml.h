// The text of deploy/hands/barrett.toml, built into the library.
#pragma once

namespace boxgrasp {

extern const char* const kBarrettToml;

}  // namespace boxgrasp
