#include "boxgrasp/training/stability.h"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "boxgrasp/base/error.h"
#include "boxgrasp/base/parallel.h"
#include "boxgrasp/base/random.h"

namespace boxgrasp {
namespace {

constexpr double kOutlierSpace = 2.0;  // outliers fill the cloud's bounds, this much larger

PointCloud withNoise(const PointCloud& cloud, double deviation_m, std::mt19937_64& random) {
  PointCloud noisy = cloud;
  for (auto* axis : {&noisy.x, &noisy.y, &noisy.z}) {
    for (float& value : *axis) value += static_cast<float>(deviation_m * normal(random));
  }
  return noisy;
}

// The points that stay when each vanishes with its own chance.
template <typename Chance>
PointCloud thinned(const PointCloud& cloud, const Chance& chance, std::mt19937_64& random) {
  std::vector<std::uint32_t> kept;
  for (std::uint32_t i = 0; i < cloud.size(); ++i) {
    if (uniform(random) >= chance(i)) kept.push_back(i);
  }
  if (kept.empty()) kept.push_back(0);
  return select(cloud, kept);
}

Vector3d randomDirection(std::mt19937_64& random) {
  const double x = normal(random), y = normal(random), z = normal(random);
  return Vector3d(x, y, z).normalized();
}

PointCloud faded(const PointCloud& cloud, double amount, std::mt19937_64& random) {
  const Vector3d direction = randomDirection(random);
  const auto height = [&](std::uint32_t i) { return direction.dot(cloud.point(i)); };
  double low = height(0), high = low;
  for (std::uint32_t i = 1; i < cloud.size(); ++i) {
    low = std::min(low, height(i));
    high = std::max(high, height(i));
  }
  const double span = std::max(high - low, 1e-12);
  return thinned(
      cloud, [&](std::uint32_t i) { return amount * (height(i) - low) / span; }, random);
}

PointCloud withOutliers(const PointCloud& cloud, double amount, std::mt19937_64& random) {
  const Eigen::AlignedBox3d box = bounds(cloud);
  PointCloud result = cloud;
  const auto count = static_cast<std::size_t>(std::lround(amount * static_cast<double>(cloud.size())));
  for (std::size_t i = 0; i < count; ++i) {
    const double x = uniform(random, -0.5, 0.5), y = uniform(random, -0.5, 0.5),
                 z = uniform(random, -0.5, 0.5);
    result.push(box.center() + kOutlierSpace * box.sizes().cwiseProduct(Vector3d(x, y, z)));
  }
  return result;
}

struct Level {
  Damage damage;
  double amount;
};

std::vector<Level> levelsOf(const StabilityOptions& options) {
  std::vector<Level> levels;
  const auto append = [&](Damage damage, int count, double most) {
    for (int k = 1; k <= count; ++k) levels.push_back({damage, most * k / count});
  };
  append(Damage::noise, options.noise_levels, options.max_noise);
  append(Damage::removal, options.removal_levels, options.max_removal);
  append(Damage::outliers, options.outlier_levels, options.max_outliers);
  append(Damage::fading, options.fading_levels, options.max_fading);
  return levels;
}

StabilityTrial compared(const BoxTree& whole, const BoxTree& tree, const Level& level,
                        const SimilarityOptions& similarity) {
  const ConstellationSize a = constellationSize(whole, similarity.scale_m),
                          b = constellationSize(tree, similarity.scale_m);
  return {level.damage,
          level.amount,
          tree.leaves().size(),
          std::abs(a.distance - b.distance),
          std::abs(a.volume - b.volume),
          similar(whole, tree, similarity)};
}

template <typename Counts>
double shareOf(const std::vector<StabilityTrial>& trials, const Counts& counts) {
  std::size_t all = 0, similar = 0;
  for (const StabilityTrial& trial : trials) {
    all += counts(trial);
    similar += counts(trial) && trial.similar;
  }
  return all ? static_cast<double>(similar) / static_cast<double>(all) : -1.0;
}

SimilarityOptions scaledTo(const BoxTree& whole, SimilarityOptions similarity) {
  if (similarity.scale_m < 0) similarity.scale_m = whole.nodes.front().box.extents.maxCoeff();
  return similarity;
}

}  // namespace

void StabilityOptions::validate() const {
  for (const auto& [name, levels] : {std::pair{"noise_levels", noise_levels},
                                     {"removal_levels", removal_levels},
                                     {"outlier_levels", outlier_levels},
                                     {"fading_levels", fading_levels}})
    requireOption(levels >= 0 && levels <= 1000, name, levels, "in [0, 1000]");
  requireOption(max_noise > 0 && max_noise < 1, "max_noise", max_noise, "in (0, 1)");
  requireOption(max_removal > 0 && max_removal < 1, "max_removal", max_removal, "in (0, 1)");
  requireOption(max_outliers > 0 && max_outliers < 1, "max_outliers", max_outliers, "in (0, 1)");
  requireOption(max_fading > 0 && max_fading < 1, "max_fading", max_fading, "in (0, 1)");
  requireOption(threads >= 0, "threads", threads, "at least 0");
  decomposition.validate();
  similarity.validate();
}

PointCloud damaged(const PointCloud& cloud, Damage damage, double amount, double size_m, std::uint64_t seed) {
  assert(!cloud.empty());
  std::mt19937_64 random(seed);
  switch (damage) {
    case Damage::noise:
      return withNoise(cloud, amount * size_m, random);
    case Damage::removal:
      return thinned(
          cloud, [&](std::uint32_t) { return amount; }, random);
    case Damage::outliers:
      return withOutliers(cloud, amount, random);
    case Damage::fading:
      break;
  }
  return faded(cloud, amount, random);
}

double StabilityReport::similarShare() const {
  return shareOf(trials, [](const StabilityTrial&) { return true; });
}

double StabilityReport::similarShare(Damage damage) const {
  return shareOf(trials, [damage](const StabilityTrial& trial) { return trial.damage == damage; });
}

StabilityReport measureStability(const PointCloud& cloud, const StabilityOptions& options,
                                 const StopToken& stop) {
  options.validate();
  const BoxTree whole = decompose(cloud, options.decomposition, stop);
  const SimilarityOptions similarity = scaledTo(whole, options.similarity);
  const std::vector<Level> levels = levelsOf(options);
  StabilityReport report{whole.leaves().size(), std::vector<StabilityTrial>(levels.size())};
  parallelFor(levels.size(), options.threads, [&](std::size_t i) {
    const double size_m = whole.nodes.front().box.extents.maxCoeff();
    const PointCloud other =
        damaged(cloud, levels[i].damage, levels[i].amount, size_m, options.seed + 1000 * (i + 1));
    report.trials[i] = compared(whole, decompose(other, options.decomposition, stop), levels[i], similarity);
  });
  return report;
}

std::vector<GainPoint> constellationsOver(const std::vector<double>& gains, const PointCloud& cloud,
                                          const DecompositionOptions& options,
                                          const SimilarityOptions& similarity, const StopToken& stop) {
  std::vector<GainPoint> curve;
  BoxTree last;
  for (const double t : gains) {
    DecompositionOptions at_t = options;
    at_t.gain_t = t;
    BoxTree tree = decompose(cloud, at_t, stop);
    GainPoint point{t, tree.leaves().size(), tree.leafVolume() / tree.nodes.front().box.volume(), false};
    if (!curve.empty()) point.similar_to_last = similar(last, tree, similarity);
    curve.push_back(point);
    last = std::move(tree);
  }
  return curve;
}

}  // namespace boxgrasp
