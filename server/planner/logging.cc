#include "logging.h"

#include <fmt/format.h>
#include <spdlog/pattern_formatter.h>
#include <spdlog/sinks/stdout_color_sinks.h>
#include <spdlog/spdlog.h>
#include <sys/stat.h>
#include <systemd/sd-daemon.h>
#include <unistd.h>

#include <cstdlib>
#include <map>

#include "boxgrasp/base/error.h"

namespace boxgrasp {
namespace {

class JournalLevel : public spdlog::custom_flag_formatter {
 public:
  void format(const spdlog::details::log_msg& message, const std::tm&, spdlog::memory_buf_t& to) override {
    const std::string_view prefix = prefixOf(message.level);
    to.append(prefix.data(), prefix.data() + prefix.size());
  }
  std::unique_ptr<custom_flag_formatter> clone() const override { return std::make_unique<JournalLevel>(); }

 private:
  static std::string_view prefixOf(spdlog::level::level_enum level) {
    if (level >= spdlog::level::critical) return SD_CRIT;
    if (level >= spdlog::level::err) return SD_ERR;
    if (level >= spdlog::level::warn) return SD_WARNING;
    return level >= spdlog::level::info ? SD_INFO : SD_DEBUG;
  }
};

}  // namespace

bool isJournalOnStderr() {
  const char* stream = std::getenv("JOURNAL_STREAM");
  struct stat is {};
  return stream && fstat(STDERR_FILENO, &is) == 0 && stream == fmt::format("{}:{}", is.st_dev, is.st_ino);
}

void logToStderr(bool for_journal) {
  const auto logger = spdlog::stderr_color_mt("boxgrasp-server");
  if (for_journal) {
    auto formatter = std::make_unique<spdlog::pattern_formatter>();
    formatter->add_flag<JournalLevel>('*').set_pattern("%*%v");
    logger->set_formatter(std::move(formatter));
  }
  spdlog::set_default_logger(logger);
}

spdlog::level::level_enum logLevel(const std::string& name) {
  static const std::map<std::string, spdlog::level::level_enum> levels = {{"debug", spdlog::level::debug},
                                                                          {"info", spdlog::level::info},
                                                                          {"warning", spdlog::level::warn},
                                                                          {"error", spdlog::level::err}};
  const auto level = levels.find(name);
  if (level == levels.end())
    throw InputError(fmt::format("log level '{}' is not one of debug, info, warning, error", name));
  return level->second;
}

}  // namespace boxgrasp
