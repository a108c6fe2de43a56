// The public class Raster: inputs as ingest reads them.

#include <memory>
#include <utility>
#include <variant>
#include <vector>

#include "ingest/mosaic/source.hpp"
#include "talus/ingest.hpp"

namespace talus {

struct Raster::Opened {
  Source source;
};

Raster::Raster(const std::filesystem::path& input) : Raster(std::vector<std::filesystem::path>{input}, {}) {}
Raster::Raster(const std::vector<std::filesystem::path>& inputs, const InputOptions& options)
    : opened_(std::make_unique<Opened>(Opened{Source{inputs, options}})) {}
Raster::~Raster() = default;
Raster::Raster(Raster&&) noexcept = default;
Raster& Raster::operator=(Raster&&) noexcept = default;

const Description& Raster::description() const { return opened_->source.description(); }

SampleWindow Raster::read(GridRect part) const {
  Window window = opened_->source.read(part);
  const HeightStep& step = description().step;
  SampleWindow samples{window.region, {}, std::move(window.valid)};
  std::visit(
      [&](const auto& codes) {
        samples.values.reserve(codes.size());
        for (const auto code : codes) samples.values.push_back(step.value(static_cast<double>(code)));
      },
      window.codes);
  if (samples.valid.empty()) samples.valid.assign(samples.values.size(), 1);
  return samples;
}

}  // namespace talus
