// Logs of messages.
#include "boxgrasp/messaging/event_log.h"

#include "fuzz_target.h"

namespace boxgrasp::fuzz {

void feed(Bytes bytes) {
  static const Folder kFolder;
  const auto file = kFolder.file("fuzz.log", bytes);
  accepts([&] {
    EventLogReader reader(file);
    std::size_t read = 0;
    while (const auto event = reader.next()) read += event->channel.size() + event->data.size();
    promise(read <= bytes.size());
  });
}

std::vector<std::string> seeds() {
  const Folder folder;
  {
    EventLogWriter writer(folder.path() / "seed.log");
    for (std::uint8_t i = 0; i < 5; ++i)
      writer.write("CHANNEL", 1000 * i, std::vector<std::uint8_t>(3u * i, i));
  }
  return {folder.read("seed.log")};
}

}  // namespace boxgrasp::fuzz
