// Files of keys: the secret one, and the folder of those that are trusted.
#include "boxgrasp/registry/signing.h"
#include "fuzz_target.h"

namespace boxgrasp::fuzz {

void feed(Bytes bytes) {
  static const Folder folder;
  const auto secret = folder.file("secret", bytes);
  std::filesystem::permissions(secret,
                               std::filesystem::perms::owner_read | std::filesystem::perms::owner_write);
  accepts([&] {
    const SigningKey key(secret);
    promise(isValid(key.sign(purpose::kModel, bytes), purpose::kModel, bytes));
  });
  folder.file("robot.pub", bytes);
  accepts([&] { promise(!TrustedKeys(folder.path()).empty()); });
}

std::vector<std::string> seeds() {
  const Folder folder;
  SigningKey::generate().write(folder.path() / "key");
  return {folder.read("key"), folder.read("key.pub")};
}

}  // namespace boxgrasp::fuzz
