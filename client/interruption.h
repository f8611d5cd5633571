// Ctrl-C and SIGTERM as requests to end, instead of the end of the program.
#pragma once

namespace boxgrasp {

// During its life the first signal is a request; a second one of the same kind ends the program.
class Interruption {
 public:
  Interruption();
  ~Interruption();
  Interruption(const Interruption&) = delete;
  Interruption& operator=(const Interruption&) = delete;

  bool asked() const;
  // The same once for each request.
  bool take();

 private:
  void (*before_int_)(int);
  void (*before_term_)(int);
};

}  // namespace boxgrasp
