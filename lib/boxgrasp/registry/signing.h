// Signatures: who published a model, who gave an order.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace boxgrasp {

// Ed25519 with prehash (RFC 8032, Ed25519ph). What is signed is the purpose, a zero byte, and the bytes, so
// that a signature for one purpose is none for another.
using PublicKey = std::array<std::uint8_t, 32>;

struct Signature {
  PublicKey key{};                       // of the signer
  std::array<std::uint8_t, 64> bytes{};  // all zeros: not signed
  bool empty() const;
};

// What is signed in Boxgrasp.
namespace purpose {
inline constexpr std::string_view kModel = "boxgrasp model";    // the bytes of a model file
inline constexpr std::string_view kModels = "boxgrasp models";  // an order to the server's registry
}  // namespace purpose

class SigningKey {
 public:
  static SigningKey generate();
  // Reads a file that write() made. Throws InputError naming file and remedy: not such a file, or readable by
  // others than its owner.
  explicit SigningKey(const std::filesystem::path& file);
  ~SigningKey();  // wipes the secret
  SigningKey(const SigningKey&) = default;
  SigningKey& operator=(const SigningKey&) = default;

  PublicKey publicKey() const;
  Signature sign(std::string_view purpose, std::span<const std::uint8_t> bytes) const;

  // The secret into `file`, for its owner alone, and the public half into "<file>.pub". Throws InputError
  // where one of them exists or cannot be written.
  void write(const std::filesystem::path& file) const;

 private:
  SigningKey() = default;
  std::array<std::uint8_t, 64> secret_{};
};

// True if the signature is that of these bytes for this purpose by its key.
bool isValid(const Signature& signature, std::string_view purpose, std::span<const std::uint8_t> bytes);

struct TrustedKey {
  std::string name;  // of its file, without ".pub"
  PublicKey key{};
};

// Whom a server believes.
class TrustedKeys {
 public:
  TrustedKeys() = default;  // nobody
  // Every "*.pub" of the folder, by name. Throws InputError for a folder that cannot be read, or a file of
  // that ending that is no public key.
  explicit TrustedKeys(const std::filesystem::path& folder);

  bool empty() const { return keys_.empty(); }
  // Its name; null where it is not trusted.
  const std::string* nameOf(const PublicKey& key) const;

 private:
  std::vector<TrustedKey> keys_;
};

std::string hexOf(std::span<const std::uint8_t> bytes);
// Throws InputError for a text that is not exactly `bytes` in hex digits; `what` names it.
void readHex(std::string_view hex, std::span<std::uint8_t> bytes, std::string_view what);

}  // namespace boxgrasp
