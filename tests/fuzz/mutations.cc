// Feeds a target mutations of its seeds, the same ones for the same -seed, for compilers without libFuzzer: it does not
// learn from what it reaches, but neither does it need anything. Knows libFuzzer's options that
// tests/fuzz/run gives: -runs=N, -max_total_time=SECONDS, -max_len=BYTES, -rss_limit_mb=MB, -seed=N;
// others are ignored; folders hold more seeds.
#include <sys/resource.h>

#include <algorithm>
#include <charconv>
#include <chrono>
#include <csignal>
#include <cstring>

#include "boxgrasp/base/random.h"
#include "write_seeds.h"

namespace boxgrasp::fuzz {
namespace {

using Input = std::vector<std::uint8_t>;
using Clock = std::chrono::steady_clock;

struct Options {
  std::uint64_t runs = 10'000, max_total_time = 3600, max_len = 1 << 16, rss_limit_mb = 2048, seed = 1;
};

void readOption(std::string_view argument, Options& options) {
  const auto is = [&](std::string_view name, std::uint64_t& value) {
    if (argument.starts_with(name))
      std::from_chars(argument.data() + name.size(), argument.data() + argument.size(), value);
  };
  is("-runs=", options.runs);
  is("-max_total_time=", options.max_total_time);
  is("-max_len=", options.max_len);
  is("-rss_limit_mb=", options.rss_limit_mb);
  is("-seed=", options.seed);
}

std::vector<Input> corpus(int argc, char** argv) {
  std::vector<Input> inputs;
  for (const std::string& seed : seeds()) inputs.emplace_back(seed.begin(), seed.end());
  for (int i = 1; i < argc; ++i) {
    if (argv[i][0] == '-') continue;
    std::vector<std::filesystem::path> files;
    for (const auto& entry : std::filesystem::directory_iterator(argv[i])) files.push_back(entry.path());
    std::sort(files.begin(), files.end());
    for (const auto& file : files) {
      std::ifstream stream(file, std::ios::binary);
      inputs.emplace_back(std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>());
    }
  }
  return inputs;
}

// Values at which readers go wrong.
constexpr std::uint64_t kAwkward[] = {0,          1,
                                      0x7f,       0x80,
                                      0xff,       0x7fff,
                                      0x8000,     0xffff,
                                      0x7fffffff, 0x80000000,
                                      0xffffffff, 0x7fffffffffffffff,
                                      1u << 28,   (1u << 28) + 1};

void overwrite(Input& input, std::mt19937_64& random) {
  const std::uint64_t value = kAwkward[uniformIndex(random, std::size(kAwkward))];
  const std::size_t size = std::size_t{1} << uniformIndex(random, 4);
  if (input.size() < size) return;
  const std::size_t at = uniformIndex(random, input.size() - size + 1);
  const bool big_endian = uniformIndex(random, 2) == 0;
  for (std::size_t i = 0; i < size; ++i)
    input[at + i] = static_cast<std::uint8_t>(value >> 8 * (big_endian ? size - 1 - i : i));
}

// A piece of one input goes into another: at a place, or in the place of as many bytes.
void splice(Input& input, const Input& other, std::mt19937_64& random) {
  if (other.empty()) return;
  const std::size_t from = uniformIndex(random, other.size());
  const std::size_t count = 1 + uniformIndex(random, std::min<std::size_t>(other.size() - from, 64));
  const std::size_t at = uniformIndex(random, input.size() + 1);
  const std::size_t replaced = uniformIndex(random, 2) == 0 ? 0 : std::min(count, input.size() - at);
  input.erase(input.begin() + at, input.begin() + at + replaced);
  input.insert(input.begin() + at, other.begin() + from, other.begin() + from + count);
}

void mutate(Input& input, const std::vector<Input>& all, std::mt19937_64& random) {
  const std::size_t at = input.empty() ? 0 : uniformIndex(random, input.size());
  switch (input.empty() ? 4 : uniformIndex(random, 6)) {
    case 0:
      input[at] ^= static_cast<std::uint8_t>(1u << uniformIndex(random, 8));
      break;
    case 1:
      input[at] = static_cast<std::uint8_t>(random());
      break;
    case 2:
      overwrite(input, random);
      break;
    case 3:
      input.erase(input.begin() + at, input.begin() + at + 1 +
                                          uniformIndex(random, std::min<std::size_t>(input.size() - at, 64)));
      break;
    case 4:
      splice(input, all[uniformIndex(random, all.size())], random);
      break;
    default:
      if (uniformIndex(random, 8) == 0) input.resize(at);
  }
}

Input last;

// What ended the program is left in a file, as libFuzzer does.
void keepLast(int signal) {
  if (FILE* file = std::fopen("crash-input", "wb")) {
    std::fwrite(last.data(), 1, last.size(), file);
    std::fclose(file);
  }
  std::signal(signal, SIG_DFL);
  std::raise(signal);
}

// Sanitizers reserve more addresses than any limit.
void limitMemory([[maybe_unused]] std::uint64_t megabytes) {
#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
  const rlimit limit{megabytes << 20, megabytes << 20};
  setrlimit(RLIMIT_AS, &limit);
#endif
}

std::uint64_t run(const Options& options, const std::vector<Input>& inputs) {
  const auto end = Clock::now() + std::chrono::seconds(options.max_total_time);
  std::mt19937_64 random(options.seed);
  std::uint64_t runs = 0;
  for (; runs < options.runs && Clock::now() < end; ++runs) {
    last = inputs[runs % inputs.size()];
    const std::uint64_t mutations = runs < inputs.size() ? 0 : 1 + uniformIndex(random, 5);
    for (std::uint64_t i = 0; i < mutations; ++i) mutate(last, inputs, random);
    if (last.size() > options.max_len) last.resize(options.max_len);
    feed(last);
  }
  return runs;
}

}  // namespace
}  // namespace boxgrasp::fuzz

int main(int argc, char** argv) {
  using namespace boxgrasp::fuzz;
  if (writesSeeds(argc, argv)) return 0;
  Options options;
  for (int i = 1; i < argc; ++i) readOption(argv[i], options);
  const auto inputs = corpus(argc, argv);
  limitMemory(options.rss_limit_mb);
  for (const int signal : {SIGSEGV, SIGABRT, SIGILL, SIGTRAP, SIGFPE, SIGBUS}) std::signal(signal, keepLast);
  const auto start = Clock::now();
  const std::uint64_t runs = run(options, inputs);
  const auto time = std::chrono::duration_cast<std::chrono::seconds>(Clock::now() - start);
  fmt::print(stderr, "Done {} runs in {} second(s)\n", runs, time.count());
}
