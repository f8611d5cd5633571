#include "server_options.h"

#include "boxgrasp/base/error.h"
#include "boxgrasp/registry/model_registry.h"

namespace boxgrasp {

void ServerOptions::validate() const {
  requireOption(workers >= 1 && workers <= 256, "workers", workers, "1 to 256");
  requireOption(queue >= 1 && queue <= 4000, "queue", queue, "1 to 4000");
  requireOption(deadline_s > 0 && deadline_s <= 86400, "deadline_s", deadline_s,
                "above 0, at most 86400 (a day)");
  requireOption(oldest_model.empty() || isModelTime(oldest_model), "oldest_model", oldest_model,
                "empty or a time like 2026-01-31T00:00:00Z");
  requireOption(shown_plans >= 1 && shown_plans <= 1000, "shown_plans", shown_plans, "1 to 1000");
  requireOption(stop_s >= 0 && stop_s <= 86400, "stop_s", stop_s, "0 to 86400 (a day)");
}

ServerOptions readServerOptions(ConfigFile& file) {
  ServerOptions options;
  file.read("server", "lcm_url", options.lcm_url);
  file.read("server", "workers", options.workers);
  file.read("server", "queue", options.queue);
  file.read("server", "queue_bytes", options.queue_bytes);
  file.read("server", "deadline_s", options.deadline_s);
  file.read("server", "cloud_channel", options.cloud_channel);
  file.read("server", "receive_buffer_bytes", options.receive_buffer_bytes);
  file.read("server", "answers", options.answers);
  file.read("server", "answers_bytes", options.answers_bytes);
  file.read("server", "stop_s", options.stop_s);
  file.read("server", "state_dir", options.state_dir);
  file.read("server", "trusted_keys", options.trusted_keys);
  file.read("server", "oldest_model", options.oldest_model);
  file.read("server", "http", options.http);
  file.read("server", "metrics", options.metrics);
  file.read("server", "shown_plans", options.shown_plans);
  file.read("server", "shown_bytes", options.shown_bytes);
  file.validate("server", [&] { options.validate(); });
  return options;
}

}  // namespace boxgrasp
