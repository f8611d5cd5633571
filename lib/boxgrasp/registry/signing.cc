#include "boxgrasp/registry/signing.h"

#include <fmt/format.h>
#include <sodium.h>
#include <sys/stat.h>

#include <algorithm>
#include <stdexcept>

#include "boxgrasp/base/durable_file.h"
#include "boxgrasp/base/error.h"

namespace boxgrasp {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kSecretHead = "boxgrasp-secret-key-1 ", kPublicHead = "boxgrasp-public-key-1 ";
constexpr std::uintmax_t kMaxKeyFileBytes = 4096;

void requireSodium() {
  if (sodium_init() < 0) throw std::runtime_error("libsodium cannot be initialised");
}

std::string keyText(std::string_view head, std::span<const std::uint8_t> key) {
  return fmt::format("{}{}\n", head, hexOf(key));
}

// The 32 bytes of a key file: its head, hex digits, a line's end.
void readKey(const fs::path& file, std::string_view head, std::span<std::uint8_t> key) {
  std::string text = readWhole(file, kMaxKeyFileBytes);
  while (!text.empty() && text.back() == '\n') text.pop_back();
  if (!text.starts_with(head))
    throw InputError(fmt::format("key file '{}' does not begin with '{}'; boxgrasp-trainer keygen makes keys",
                                 file.string(), head));
  readHex(std::string_view(text).substr(head.size()), key, fmt::format("key file '{}'", file.string()));
  sodium_memzero(text.data(), text.size());
}

void requirePrivate(const fs::path& file) {
  struct stat info {};
  if (stat(file.c_str(), &info) != 0 || (info.st_mode & 077) == 0) return;
  throw InputError(fmt::format(
      "key file '{0}' can be read or written by others than its owner (mode {1:o}); chmod 600 '{0}'",
      file.string(), info.st_mode & 0777));
}

void requireNew(const fs::path& file) {
  if (fs::exists(fs::symlink_status(file)))
    throw InputError(fmt::format(
        "'{}' exists already; a key that is overwritten is lost: choose another name, or move it away",
        file.string()));
}

class Prehash {
 public:
  Prehash(std::string_view purpose, std::span<const std::uint8_t> bytes) {
    requireSodium();
    crypto_sign_init(&state_);
    crypto_sign_update(&state_, reinterpret_cast<const unsigned char*>(purpose.data()), purpose.size());
    constexpr unsigned char kEnd = 0;
    crypto_sign_update(&state_, &kEnd, 1);
    crypto_sign_update(&state_, bytes.data(), bytes.size());
  }
  crypto_sign_state* state() { return &state_; }

 private:
  crypto_sign_state state_;
};

}  // namespace

bool Signature::empty() const {
  return std::all_of(bytes.begin(), bytes.end(), [](std::uint8_t b) { return b == 0; });
}

SigningKey SigningKey::generate() {
  requireSodium();
  SigningKey key;
  PublicKey unused;
  crypto_sign_keypair(unused.data(), key.secret_.data());
  return key;
}

SigningKey::SigningKey(const fs::path& file) {
  requireSodium();
  std::array<std::uint8_t, crypto_sign_SEEDBYTES> seed;
  readKey(file, kSecretHead, seed);
  requirePrivate(file);
  PublicKey unused;
  crypto_sign_seed_keypair(unused.data(), secret_.data(), seed.data());
  sodium_memzero(seed.data(), seed.size());
}

SigningKey::~SigningKey() { sodium_memzero(secret_.data(), secret_.size()); }

PublicKey SigningKey::publicKey() const {
  PublicKey key;
  crypto_sign_ed25519_sk_to_pk(key.data(), secret_.data());
  return key;
}

Signature SigningKey::sign(std::string_view purpose, std::span<const std::uint8_t> bytes) const {
  Signature signature{publicKey(), {}};
  crypto_sign_final_create(Prehash(purpose, bytes).state(), signature.bytes.data(), nullptr, secret_.data());
  return signature;
}

void SigningKey::write(const fs::path& file) const {
  const fs::path public_file = file.string() + ".pub";
  requireNew(file);
  requireNew(public_file);
  std::array<std::uint8_t, crypto_sign_SEEDBYTES> seed;
  crypto_sign_ed25519_sk_to_seed(seed.data(), secret_.data());
  writeDurably(file, keyText(kSecretHead, seed), Readers::owner);
  writeDurably(public_file, keyText(kPublicHead, publicKey()));
}

bool isValid(const Signature& signature, std::string_view purpose, std::span<const std::uint8_t> bytes) {
  return crypto_sign_final_verify(Prehash(purpose, bytes).state(), signature.bytes.data(),
                                  signature.key.data()) == 0;
}

TrustedKeys::TrustedKeys(const fs::path& folder) {
  std::error_code error;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder, error)) {
    if (entry.path().extension() != ".pub") continue;
    TrustedKey trusted{entry.path().stem().string(), {}};
    readKey(entry.path(), kPublicHead, trusted.key);
    keys_.push_back(trusted);
  }
  if (error)
    throw InputError(
        fmt::format("the folder of trusted keys '{}' cannot be read: {}; name a folder with the public keys "
                    "(*.pub) of those "
                    "who may publish models",
                    folder.string(), error.message()));
  std::sort(keys_.begin(), keys_.end(), [](const auto& a, const auto& b) { return a.name < b.name; });
}

const std::string* TrustedKeys::nameOf(const PublicKey& key) const {
  const auto found =
      std::find_if(keys_.begin(), keys_.end(), [&](const TrustedKey& trusted) { return trusted.key == key; });
  return found == keys_.end() ? nullptr : &found->name;
}

std::string hexOf(std::span<const std::uint8_t> bytes) {
  std::string hex(2 * bytes.size() + 1, '\0');
  sodium_bin2hex(hex.data(), hex.size(), bytes.data(), bytes.size());
  hex.pop_back();
  return hex;
}

void readHex(std::string_view hex, std::span<std::uint8_t> bytes, std::string_view what) {
  const char* end = nullptr;
  std::size_t read = 0;
  if (hex.size() == 2 * bytes.size() &&
      sodium_hex2bin(bytes.data(), bytes.size(), hex.data(), hex.size(), nullptr, &read, &end) == 0 &&
      end == hex.data() + hex.size())
    return;
  throw InputError(
      fmt::format("{}: {} hex digits were expected; restore it from a copy", what, 2 * bytes.size()));
}

}  // namespace boxgrasp
