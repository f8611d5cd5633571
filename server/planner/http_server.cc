#include "http_server.h"

#include <arpa/inet.h>
#include <fmt/format.h>
#include <httplib.h>
#include <poll.h>
#include <sys/resource.h>
#include <sys/socket.h>

#include <charconv>
#include <optional>
#include <semaphore>
#include <thread>

#include "boxgrasp/base/error.h"

namespace boxgrasp {
namespace {

using Clock = std::chrono::steady_clock;

constexpr int kThreads = 2;
constexpr int kConnections = 16;
constexpr std::size_t kMaxHeadBytes = 16384;
constexpr std::chrono::seconds kReadPatience{5}, kWritePatience{20}, kFarewell{1};
constexpr int kTick_ms = 100;  // how late it may be noticed that the server ends
constexpr int kNice = 10;      // planning comes first

// The library's threads, but connections above a number are not accepted: its own queue has no end.
class BoundedPool : public httplib::ThreadPool {
 public:
  BoundedPool() : ThreadPool(kThreads) {}
  void enqueue(std::function<void()> task) override {
    places_.acquire();
    ThreadPool::enqueue([this, task = std::move(task)] {
      task();
      places_.release();
    });
  }

 private:
  std::counting_semaphore<kConnections> places_{kConnections};
};

// One connection, with a time by which it is over.
class Connection : public httplib::Stream {
 public:
  Connection(int socket, const std::atomic<bool>& ending) : socket_(socket), ending_(ending) {}

  // The request up to its empty line; nullopt when it does not come, or is too long.
  std::optional<std::string> readHead() {
    late_ = Clock::now() + kReadPatience;
    std::string head;
    while (head.find("\r\n\r\n") == std::string::npos) {
      char part[4096];
      const ssize_t count = waitFor(POLLIN) ? recv(socket_, part, sizeof part, MSG_DONTWAIT) : -1;
      if (count <= 0 || head.size() + static_cast<std::size_t>(count) > kMaxHeadBytes) return std::nullopt;
      head.append(part, static_cast<std::size_t>(count));
    }
    late_ = Clock::now() + kWritePatience;
    return head;
  }
  // Lets the other side read to the end before the connection goes.
  void finish() {
    shutdown(socket_, SHUT_WR);
    late_ = std::min(late_, Clock::now() + kFarewell);
    char rest[4096];
    while (waitFor(POLLIN) && recv(socket_, rest, sizeof rest, MSG_DONTWAIT) > 0) {
    }
  }
  // What the library is to read.
  void give(std::string input) { input_ = std::move(input); }

  bool is_readable() const override { return !input_.empty(); }
  bool is_writable() const override { return true; }
  ssize_t read(char* to, size_t size) override {
    const std::size_t count = input_.copy(to, size);
    input_.erase(0, count);
    return static_cast<ssize_t>(count);
  }
  ssize_t write(const char* from, size_t size) override {
    return waitFor(POLLOUT) ? send(socket_, from, size, MSG_NOSIGNAL | MSG_DONTWAIT) : -1;
  }
  void get_remote_ip_and_port(std::string&, int&) const override {}
  void get_local_ip_and_port(std::string&, int&) const override {}
  socket_t socket() const override { return socket_; }

 private:
  bool waitFor(short what) const {
    pollfd ready{socket_, what, 0};
    while (!ending_ && Clock::now() < late_) {
      if (poll(&ready, 1, kTick_ms) > 0) return true;
    }
    return false;
  }

  const int socket_;
  const std::atomic<bool>& ending_;
  Clock::time_point late_;
  std::string input_;
};

std::string_view wordOf(std::string_view& line) {
  const std::size_t end = std::min(line.find(' '), line.size());
  const std::string_view word = line.substr(0, end);
  line.remove_prefix(std::min(end + 1, line.size()));
  return word;
}

std::string hostIn(const std::string& head) {
  for (std::size_t at = head.find("\r\n"); at + 2 < head.size(); at = head.find("\r\n", at + 2)) {
    const std::string_view line = std::string_view(head).substr(at + 2, head.find("\r\n", at + 2) - at - 2);
    if (line.size() < 5 || strncasecmp(line.data(), "host:", 5) != 0) continue;
    const std::size_t begin = line.find_first_not_of(' ', 5);
    return std::string(line.substr(std::min(begin, line.size())));
  }
  return "";
}

bool isAddress(const std::string& host) {
  in6_addr any;
  return inet_pton(AF_INET, host.c_str(), &any) == 1 || inet_pton(AF_INET6, host.c_str(), &any) == 1;
}

std::string withoutPort(const std::string& authority) {
  if (authority.starts_with('[')) return authority.substr(1, authority.find(']') - 1);
  return authority.substr(0, authority.rfind(':'));
}

bool isOwnHost(const std::string& head) {
  const std::string host = withoutPort(hostIn(head));
  return host == "localhost" || isAddress(host);
}

}  // namespace

HttpAddress HttpAddress::parse(const std::string& text) {
  const std::size_t colon = text.rfind(':');
  HttpAddress address;
  if (colon != std::string::npos) {
    const char *begin = text.data() + colon + 1, *end = text.data() + text.size();
    const auto [stop, error] = std::from_chars(begin, end, address.port);
    address.host = withoutPort(text);
    const bool ok = error == std::errc{} && stop == end && address.port >= 0 && address.port <= 65535;
    if (ok && isAddress(address.host)) return address;
  }
  throw InputError(fmt::format(
      "web address '{}' is not ADDRESS:PORT; write 127.0.0.1:8080, [::1]:8080, or 0.0.0.0:8080 for all "
      "networks of this machine",
      text));
}

bool HttpAddress::isLoopback() const { return host == "::1" || host.starts_with("127."); }

// The library parses, routes and writes; what comes in reaches it only as a request line of known form, so
// that headers without end, bodies, ranges and compression are out of reach.
struct HttpServer::Impl : httplib::Server {
  Impl(const std::string& text, HttpServer::Handler reply)
      : address(HttpAddress::parse(text)), handler(std::move(reply)) {
    new_task_queue = [] { return new BoundedPool; };
    set_keep_alive_max_count(1);
    set_pre_routing_handler([this](const httplib::Request& request, httplib::Response& response) {
      answer(request, response);
      return HandlerResponse::Handled;
    });
    bind(text);
    thread = std::thread([this] { listen_after_bind(); });
    while (!is_running()) std::this_thread::yield();  // stop() has no effect before
  }
  ~Impl() override {
    ending = true;
    stop();
    thread.join();
  }

  void bind(const std::string& text) {
    // The library's own options let two servers share a port, and each answer some of the requests.
    set_socket_options([](socket_t socket) {
      const int on = 1;
      setsockopt(socket, SOL_SOCKET, SO_REUSEADDR, &on, sizeof on);
    });
    if (address.port == 0)
      address.port = bind_to_any_port(address.host);
    else if (!bind_to_port(address.host, address.port))
      address.port = -1;
    if (address.port < 0)
      throw InputError(fmt::format(
          "web address '{}' cannot be used: it is taken, or none of this machine's; ss -ltnp shows "
          "who has it",
          text));
    const bool is_v6 = address.host.find(':') != std::string::npos;
    url = fmt::format("http://{}:{}/", is_v6 ? "[" + address.host + "]" : address.host, address.port);
  }

  void answer(const httplib::Request& request, httplib::Response& response) const {
    WebReply reply = handler(request.path);
    response.status = reply.status;
    response.set_header("Content-Security-Policy", reply.policy);
    response.set_header("X-Content-Type-Options", "nosniff");
    response.set_header("X-Frame-Options", "DENY");
    response.set_header("Referrer-Policy", "no-referrer");
    response.set_header("Cross-Origin-Resource-Policy", "same-origin");
    response.set_header("Cache-Control", "no-store");
    response.body = std::move(reply.body);
    response.set_header("Content-Type", reply.type);
  }

  bool process_and_close_socket(socket_t socket) override {
    setpriority(PRIO_PROCESS, 0, kNice);  // of this thread; where it may not, it may not
    Connection connection(socket, ending);
    if (const auto head = connection.readHead()) serve(connection, *head);
    connection.finish();
    close(socket);
    return true;
  }

  void serve(Connection& connection, const std::string& head) {
    std::string_view line = std::string_view(head).substr(0, head.find("\r\n"));
    const std::string_view method = wordOf(line), target = wordOf(line);
    const std::string_view path = target.substr(0, target.find('?'));
    if (method != "GET" && method != "HEAD")
      return refuse(connection, "405 Method Not Allowed\r\nAllow: GET, HEAD");
    if (!path.starts_with('/') || !line.starts_with("HTTP/1.") || path.find('%') != std::string::npos)
      return refuse(connection, "400 Bad Request");
    if (address.isLoopback() && !isOwnHost(head)) return refuse(connection, "421 Misdirected Request");
    connection.give(fmt::format("{} {} HTTP/1.1\r\nConnection: close\r\n\r\n", method, path));
    bool closed = false;
    process_request(connection, true, closed, nullptr);
  }

  static void refuse(Connection& connection, const std::string& status) {
    const std::string text =
        fmt::format("HTTP/1.1 {}\r\nConnection: close\r\nContent-Length: 0\r\n\r\n", status);
    connection.write(text.data(), text.size());
  }

  HttpAddress address;
  const HttpServer::Handler handler;
  std::string url;
  std::atomic<bool> ending = false;
  std::thread thread;
};

HttpServer::HttpServer(const std::string& address, Handler handler)
    : impl_(std::make_unique<Impl>(address, std::move(handler))) {}

HttpServer::~HttpServer() = default;

const std::string& HttpServer::url() const { return impl_->url; }

}  // namespace boxgrasp
