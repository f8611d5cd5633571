#include "boxgrasp/planning/config_file.h"

#include <fmt/format.h>
#include <toml++/toml.h>

#include <algorithm>
#include <fstream>
#include <limits>
#include <map>
#include <numeric>
#include <optional>
#include <set>
#include <sstream>
#include <type_traits>

#include "boxgrasp/base/error.h"

namespace boxgrasp {
namespace {

std::string textOf(const std::filesystem::path& file) {
  std::ifstream in(file);
  std::ostringstream text;
  // An empty file is legal, but leaves the stream failed as an unreadable one does.
  if (!in || std::filesystem::is_directory(file) ||
      (!(text << in.rdbuf()) && !std::filesystem::is_empty(file)))
    throw InputError(
        fmt::format("configuration '{}' cannot be read; check the path and the permissions", file.string()));
  return text.str();
}

// The number of letters to insert, remove or exchange (Levenshtein).
std::size_t editDistance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), 0);
  for (std::size_t i = 0; i < a.size(); ++i) {
    std::size_t diagonal = row[0];
    row[0] = i + 1;
    for (std::size_t j = 0; j < b.size(); ++j) {
      const std::size_t exchanged = diagonal + (a[i] != b[j]);
      diagonal = row[j + 1];
      row[j + 1] = std::min({exchanged, row[j] + 1, diagonal + 1});
    }
  }
  return row.back();
}

// " (did you mean 'x'?)" for the nearest of the names, if one is near.
std::string suggestion(std::string_view given, const std::set<std::string>& names) {
  const auto nearest = std::min_element(names.begin(), names.end(), [&](const auto& a, const auto& b) {
    return editDistance(given, a) < editDistance(given, b);
  });
  if (nearest == names.end() || editDistance(given, *nearest) > 1 + given.size() / 3) return "";
  return fmt::format("; did you mean '{}'?", *nearest);
}

std::string joined(const std::vector<std::string>& names) {
  std::string text;
  for (const std::string& name : names) text += fmt::format("{}\"{}\"", text.empty() ? "" : ", ", name);
  return text;
}

}  // namespace

struct ConfigFile::Impl {
  std::string name;
  toml::table root;
  std::map<std::string, std::set<std::string>> known;  // keys by section
  std::set<std::string> skipped;
  std::vector<std::string> absent, changed;

  [[noreturn]] void fail(const toml::source_region& at, const std::string& what) const {
    throw InputError(fmt::format("{}:{}:{}: {}", name, at.begin.line, at.begin.column, what));
  }

  toml::table parse(const std::string& text) const try {
    return toml::parse(text, name);
  } catch (const toml::parse_error& error) {
    fail(error.source(), fmt::format("not TOML: {}", error.description()));
  }

  // Where the section's keys are; null where the file has no such section.
  const toml::table* table(const std::string& section) const {
    if (section.empty()) return &root;
    const toml::node* node = root.get(section);
    if (node && !node->is_table())
      fail(node->source(), fmt::format("'{0}' must be a section; write [{0}]", section));
    return node ? node->as_table() : nullptr;
  }

  static std::string pathOf(const std::string& section, const std::string& key) {
    return section.empty() ? key : fmt::format("{}.{}", section, key);
  }

  const toml::node* find(const std::string& section, const std::string& key) {
    known[section].insert(key);
    const toml::table* keys = table(section);
    const toml::node* node = keys ? keys->get(key) : nullptr;
    if (!node) absent.push_back(pathOf(section, key));
    return node;
  }

  // A value of exactly the TOML type; whole numbers count as floating-point ones.
  template <typename T>
  T value(const toml::node& node, const std::string& key, std::string_view what) const {
    const bool fits =
        std::is_same_v<T, double> ? node.is_number() : node.is_value() && node.type() == typeOf<T>();
    if (!fits) fail(node.source(), fmt::format("'{}' must be {}", key, what));
    return *node.value<T>();
  }
  template <typename T>
  static constexpr toml::node_type typeOf() {
    if constexpr (std::is_same_v<T, bool>) return toml::node_type::boolean;
    if constexpr (std::is_same_v<T, std::string>) return toml::node_type::string;
    return toml::node_type::integer;
  }

  template <typename T>
  void read(const std::string& section, const std::string& key, T& into, std::string_view what) {
    if (const toml::node* node = find(section, key)) assign(section, key, into, value<T>(*node, key, what));
  }
  template <typename T>
  void assign(const std::string& section, const std::string& key, T& into, const T& from_file) {
    if (into != from_file) changed.push_back(pathOf(section, key));
    into = from_file;
  }

  template <std::size_t n>
  std::array<double, n> numbers(const toml::node& node, const std::string& key) const {
    const toml::array* array = node.as_array();
    if (!array || array->size() != n)
      fail(node.source(), fmt::format("'{}' must be a list of {} numbers", key, n));
    std::array<double, n> from_file{};
    for (std::size_t i = 0; i < n; ++i)
      from_file[i] = value<double>(*array->get(i), key, "a list of numbers");
    return from_file;
  }
  template <std::size_t n>
  void readNumbers(const std::string& section, const std::string& key, std::array<double, n>& into) {
    if (const toml::node* node = find(section, key)) assign(section, key, into, numbers<n>(*node, key));
  }

  void refuseUnknownKeys(const std::string& section, const toml::table& keys) const {
    const auto known_here = known.find(section);
    const std::set<std::string> names =
        known_here == known.end() ? std::set<std::string>{} : known_here->second;
    for (const auto& [key, node] : keys) {
      const std::string text(key.str());
      if (names.contains(text) || (section.empty() && (known.contains(text) || skipped.contains(text))))
        continue;
      fail(key.source(), section.empty() ? unknownAtTop(text, node)
                                         : fmt::format("unknown key '{}' in section [{}]{}", text, section,
                                                       suggestion(text, names)));
    }
  }
  std::string unknownAtTop(const std::string& text, const toml::node& node) const {
    std::set<std::string> sections;
    for (const auto& [name_of_section, keys] : known) sections.insert(name_of_section);
    if (node.is_table()) return fmt::format("unknown section [{}]{}", text, suggestion(text, sections));
    return fmt::format("unknown key '{}' outside of any section{}", text, suggestion(text, keysAtTop()));
  }
  std::set<std::string> keysAtTop() const {
    const auto found = known.find("");
    return found == known.end() ? std::set<std::string>{} : found->second;
  }
};

ConfigFile::ConfigFile(const std::filesystem::path& file) : ConfigFile(textOf(file), file.string()) {}

ConfigFile::ConfigFile(const std::string& text, const std::string& name_for_errors)
    : impl_(std::make_unique<Impl>()) {
  impl_->name = name_for_errors;
  impl_->root = impl_->parse(text);
}

ConfigFile::~ConfigFile() = default;

void ConfigFile::read(const std::string& section, const std::string& key, bool& value) {
  impl_->read(section, key, value, "true or false");
}

void ConfigFile::read(const std::string& section, const std::string& key, int& value) {
  std::int64_t wide = value;
  impl_->read(section, key, wide, "a whole number");
  if (wide < std::numeric_limits<int>::min() || wide > std::numeric_limits<int>::max())
    impl_->fail(impl_->find(section, key)->source(),
                fmt::format("'{}' is {}, which is out of range", key, wide));
  value = static_cast<int>(wide);
}

void ConfigFile::read(const std::string& section, const std::string& key, std::uint64_t& value) {
  auto wide = static_cast<std::int64_t>(value);
  impl_->read(section, key, wide, "a whole number");
  if (wide < 0)
    impl_->fail(impl_->find(section, key)->source(),
                fmt::format("'{}' is {}, but must be at least 0", key, wide));
  value = static_cast<std::uint64_t>(wide);
}

void ConfigFile::read(const std::string& section, const std::string& key, double& value) {
  impl_->read(section, key, value, "a number");
}

void ConfigFile::read(const std::string& section, const std::string& key, std::string& value) {
  impl_->read(section, key, value, "a text in quotes");
}

void ConfigFile::read(const std::string& section, const std::string& key, std::array<double, 3>& value) {
  impl_->readNumbers(section, key, value);
}

void ConfigFile::read(const std::string& section, const std::string& key, std::array<double, 4>& value) {
  impl_->readNumbers(section, key, value);
}

void ConfigFile::read(const std::string& section, const std::string& key,
                      std::vector<std::array<double, 6>>& value) {
  const toml::node* node = impl_->find(section, key);
  if (!node) return;
  const toml::array* array = node->as_array();
  if (!array) impl_->fail(node->source(), fmt::format("'{}' must be a list of lists of 6 numbers", key));
  std::vector<std::array<double, 6>> from_file;
  for (const toml::node& one : *array) from_file.push_back(impl_->numbers<6>(one, key));
  impl_->assign(section, key, value, from_file);
}

void ConfigFile::read(const std::string& section, const std::string& key, int& value,
                      const std::vector<std::string>& names) {
  std::string text = names.at(value);
  read(section, key, text);
  const auto found = std::find(names.begin(), names.end(), text);
  if (found == names.end())
    impl_->fail(impl_->find(section, key)->source(),
                fmt::format("'{}' is \"{}\", but must be one of {}", key, text, joined(names)));
  value = static_cast<int>(found - names.begin());
}

void ConfigFile::validate(const std::string& section, const std::function<void()>& check) const try {
  check();
} catch (const InputError& error) {
  const toml::table* keys = impl_->table(section);
  impl_->fail(keys ? keys->source() : impl_->root.source(), fmt::format("[{}]: {}", section, error.what()));
}

void ConfigFile::skip(const std::string& section) { impl_->skipped.insert(section); }

void ConfigFile::finish() const {
  impl_->refuseUnknownKeys("", impl_->root);
  for (const auto& [section, keys] : impl_->known) {
    if (const toml::table* table = impl_->table(section); table && !section.empty())
      impl_->refuseUnknownKeys(section, *table);
  }
}

const std::vector<std::string>& ConfigFile::absent() const { return impl_->absent; }
const std::vector<std::string>& ConfigFile::changed() const { return impl_->changed; }

}  // namespace boxgrasp
