// A small web server for reading: GET and HEAD, whatever comes.
#pragma once

#include <functional>
#include <memory>
#include <string>

#include "boxgrasp/live/live_view.h"

namespace boxgrasp {

// HOST:PORT, as 127.0.0.1:8080 or [::1]:8080; port 0: any that is free.
struct HttpAddress {
  std::string host;
  int port = -1;
  // Throws InputError for other texts.
  static HttpAddress parse(const std::string& text);
  // Only this machine can reach it.
  bool isLoopback() const;
};

// Answers on two threads of low priority. A connection is one request, is read up to 16 kB and for 5 s, and
// is written for 20 s; connections above 16 wait in the kernel. On a loopback address, requests that name
// another host are refused, so that no page elsewhere can read what is served here by renaming itself.
class HttpServer {
 public:
  // The reply to a path, without its query; called from several threads.
  using Handler = std::function<WebReply(const std::string& path)>;

  // Throws InputError when the address cannot be used.
  HttpServer(const std::string& address, Handler handler);
  ~HttpServer();
  HttpServer(const HttpServer&) = delete;
  HttpServer& operator=(const HttpServer&) = delete;

  // As http://127.0.0.1:8080/
  const std::string& url() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace boxgrasp
