// Reading options from a TOML file whose keys are checked.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <vector>

namespace boxgrasp {

// A configuration file of sections with keys. Who reads it asks for every key that there is with read(),
// which keeps the value where the file has none, and then calls finish(), which refuses what nobody asked
// for. All errors are InputErrors with file, line and column.
class ConfigFile {
 public:
  // Throws InputError for a file that cannot be read or is not TOML.
  explicit ConfigFile(const std::filesystem::path& file);
  ConfigFile(const std::string& text, const std::string& name_for_errors);
  ~ConfigFile();
  ConfigFile(const ConfigFile&) = delete;
  ConfigFile& operator=(const ConfigFile&) = delete;

  // Puts the value of `key` in [section] into `value`, if the file has one. Section "" is the top of the
  // file. Throws InputError for a wrong type or a number that the type cannot hold.
  void read(const std::string& section, const std::string& key, bool& value);
  void read(const std::string& section, const std::string& key, int& value);
  void read(const std::string& section, const std::string& key, std::uint64_t& value);
  void read(const std::string& section, const std::string& key, double& value);
  void read(const std::string& section, const std::string& key, std::string& value);
  void read(const std::string& section, const std::string& key, std::array<double, 3>& value);
  void read(const std::string& section, const std::string& key, std::array<double, 4>& value);
  void read(const std::string& section, const std::string& key, std::vector<std::array<double, 6>>& value);

  // The same for one of several names; `value` is an index into them.
  void read(const std::string& section, const std::string& key, int& value,
            const std::vector<std::string>& names);

  // Calls check() and puts the section's place before the message of an InputError.
  void validate(const std::string& section, const std::function<void()>& check) const;

  // This section is another program's: its keys are not looked at.
  void skip(const std::string& section);

  // Throws InputError for the first section or key that was not asked for, naming the nearest that was.
  void finish() const;

  // Keys as "section.key", in the order in which they were asked for: those that do not stand in the file,
  // and those whose value in the file is another than the one that was there before.
  const std::vector<std::string>& absent() const;
  const std::vector<std::string>& changed() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace boxgrasp
