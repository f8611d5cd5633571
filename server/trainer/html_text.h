// Text for HTML pages.
#pragma once

#include <string>

namespace boxgrasp {

// As it stands in an element or in an attribute between double quotes.
std::string escaped(const std::string& text);

}  // namespace boxgrasp
