// The seam in front of LCM: opening, receiving and publishing, without LCM's ways to crash.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <stdexcept>
#include <string>

#include "boxgrasp/messaging/codec.h"

namespace boxgrasp {

// The transport died after it had been opened: the broker ended, a socket failed.
class TransportError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

struct LcmBusOptions {
  // udpm://GROUP:PORT?ttl=N, tcpq://HOST:PORT, memq://; file:// cannot carry requests and answers.
  std::string url = "udpm://239.255.76.67:7667?ttl=0";
  // Of the receiving socket. A message that does not fit is lost without a trace: 12 bytes a point.
  std::int64_t receive_buffer_bytes = 64 << 20;
};

// Bytes; -1 where the transport has no such buffer. The kernel grants at most net.core.rmem_max, except to
// root.
struct ReceiveBuffer {
  std::int64_t asked = -1;
  std::int64_t granted = -1;
};

// All calls from one thread. A handler that throws std::exception does not disturb LCM: its message goes to
// the problem handler.
class LcmBus {
 public:
  using Bytes = std::span<const std::uint8_t>;
  using Handler = std::function<void(Bytes)>;
  // What was wrong with a message: too large, or an exception from its handler. Must not throw.
  using ProblemHandler = std::function<void(const std::string& channel, const std::string& problem)>;

  // Throws InputError saying what to do when the URL is malformed, multicast has no route, the port is taken
  // by a program that does not share it, or no broker answers.
  explicit LcmBus(const LcmBusOptions& options, ProblemHandler on_problem = {});
  ~LcmBus();
  LcmBus(const LcmBus&) = delete;
  LcmBus& operator=(const LcmBus&) = delete;

  // Calls the handler with the unchecked bytes of every message on the channel, up to max_bytes; larger ones
  // are problems. The channel is a name of letters, digits, '_', '-', '/'; else InputError.
  void subscribe(const std::string& channel, std::int64_t max_bytes, Handler handler);

  // Calls the listener with every message on every channel whose name fits; '*' stands for any text. Else as
  // subscribe().
  struct Heard {
    const std::string& channel;
    Bytes bytes;
    std::int64_t utime;  // when it was received, microseconds since 1970
  };
  using Listener = std::function<void(const Heard&)>;
  void listen(const std::string& names, Listener listener);

  // Throws TransportError when the transport refuses. Multicast that nobody receives is no error.
  void publish(const std::string& channel, Bytes bytes);
  template <typename Message>
  requires requires(const Message& m) { m.getEncodedSize(); }
  void publish(const std::string& channel, const Message& message) { publish(channel, encoded(message)); }

  // Readable when messages wait: for poll() together with other descriptors.
  int fileno() const;
  // Hands every waiting message to its handler, without waiting for more. Throws TransportError.
  void dispatch();
  // Waits up to timeout_ms for messages, then dispatches them. A signal ends the wait.
  void wait(int timeout_ms);

  const ReceiveBuffer& receiveBuffer() const { return receive_buffer_; }

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
  ReceiveBuffer receive_buffer_;
};

}  // namespace boxgrasp
