// A bus whose receiving end is another process. LCM's receive thread can be crashed, and its memory grown, by
// packets that no program sees before it does; what must survive that cannot share its process. The other
// process hands every message on through a socket, and a new one takes its place when it dies.
#pragma once

#include <sys/types.h>

#include <chrono>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "boxgrasp/messaging/lcm_bus.h"

namespace boxgrasp {

struct IsolatedBusOptions {
  LcmBusOptions lcm;
  // The program of the receiving process; it has to call runReceiver(). One that loads little is back sooner.
  std::filesystem::path receiver;
  // A receiver that has grown beyond this is ended, and a new one starts: hostile senders can make LCM keep
  // memory for good. A message takes twice its size.
  std::int64_t max_receiver_bytes = 768 << 20;
};

// As LcmBus, and all calls from one thread.
class IsolatedBus {
 public:
  using Bytes = LcmBus::Bytes;
  using Handler = LcmBus::Handler;
  using ProblemHandler = LcmBus::ProblemHandler;
  // One sentence on each death of a receiver, and when its successor listens.
  using EventHandler = std::function<void(const std::string& what)>;

  // Throws as LcmBus does, and InputError for a transport within one process (memq://).
  IsolatedBus(const IsolatedBusOptions& options, ProblemHandler on_problem, EventHandler on_event);
  ~IsolatedBus();
  IsolatedBus(const IsolatedBus&) = delete;
  IsolatedBus& operator=(const IsolatedBus&) = delete;

  // Pre: not open yet.
  void subscribe(const std::string& channel, std::int64_t max_bytes, Handler handler);

  // Starts to receive, when every channel is subscribed to. Throws as LcmBus when the receiver cannot open
  // the bus.
  void open();

  void publish(const std::string& channel, Bytes bytes) { sender_.publish(channel, bytes); }
  template <typename Message>
  requires requires(const Message& m) { m.getEncodedSize(); }
  void publish(const std::string& channel, const Message& message) { sender_.publish(channel, message); }

  // Readable when messages wait, or the receiver has died; -1 while there is none. Not the same for good.
  int fileno() const { return socket_; }
  // Hands what waits to the handlers, and sees to it that there is a receiver.
  void dispatch();

  const ReceiveBuffer& receiveBuffer() const { return receive_buffer_; }
  std::int64_t restarts() const { return restarts_; }

 private:
  using Clock = std::chrono::steady_clock;
  struct Subscription {
    std::string channel;
    std::int64_t max_bytes;
    Handler handler;
  };
  // What the receiver sends before each message.
  struct Head {
    std::uint32_t kind = 0, channel = 0;
    std::uint64_t size = 0;
  };

  void start();
  void end(const std::string& why);
  void startAgain();
  bool readSome();
  void take(const Head& head, Bytes bytes);
  void deliver(const Subscription& to, Bytes bytes);
  bool sound(const Head& head) const;
  void watchGrowth();

  const IsolatedBusOptions options_;
  const ProblemHandler on_problem_;
  const EventHandler on_event_;
  LcmBus sender_;
  std::vector<Subscription> subscriptions_;
  ReceiveBuffer receive_buffer_;
  int socket_ = -1;
  pid_t receiver_ = -1;
  bool ready_ = false;
  std::string failure_;                // of the receiver to open the bus
  std::vector<std::uint8_t> partial_;  // head and payload of the message that is coming in
  std::size_t received_ = 0;           // of it
  Clock::time_point next_start_, next_watch_;
  std::int64_t restarts_ = 0;
};

// The receiving process: its main program calls this with its arguments, without its name. Returns the exit
// code once the other end is gone.
int runReceiver(int argc, char** argv);

}  // namespace boxgrasp
