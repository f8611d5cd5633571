#include "keygen_command.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "boxgrasp/registry/signing.h"
#include "print_json.h"

namespace boxgrasp {

void runKeygen(const KeygenCommand& command) {
  const SigningKey key = SigningKey::generate();
  key.write(command.out);
  if (command.json) {
    printJson(nlohmann::ordered_json{{"schema", 1},
                                     {"public_key", hexOf(key.publicKey())},
                                     {"public_key_file", command.out.string() + ".pub"},
                                     {"secret_key_file", command.out.string()}});
    return;
  }
  fmt::print(
      "public key {0} written to {1}.pub: copy it into the server's folder of trusted keys "
      "(boxgrasp-server --trusted-keys FOLDER)\n"
      "secret key written to {1}: whoever has it can publish models; give it to boxgrasp-trainer publish "
      "--key\n",
      hexOf(key.publicKey()), command.out.string());
}

}  // namespace boxgrasp
