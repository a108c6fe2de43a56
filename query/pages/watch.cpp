#include "query/pages/watch.hpp"

#include <algorithm>

#include "engine/machine/fail.hpp"

namespace talus {

void Watch::cancel() { throw Failure(Cause::cancelled, "cancelled: Question::stop was requested"); }

void Watch::add_bytes(std::uint64_t bytes) {
  if (limits_.memory_bytes == 0) return;
  const std::uint64_t now = bytes_.fetch_add(bytes, std::memory_order_relaxed) + bytes;
  if (now <= limits_.memory_bytes) return;
  fail(Cause::too_large,
       "the answer needs {} bytes or more, and Limits::memory_bytes allows {}: ask for a smaller region or a larger "
       "tolerance",
       now, limits_.memory_bytes);
}

void Watch::give_back(std::uint64_t bytes) {
  if (limits_.memory_bytes != 0) bytes_.fetch_sub(bytes, std::memory_order_relaxed);
}

void Watch::add_vertices(std::uint64_t vertices) {
  add_bytes(vertices * kBytesAVertex);
  if (limits_.vertices == 0 || is_aside_) return;
  require_vertices(vertices_.fetch_add(vertices, std::memory_order_relaxed) + vertices);
}

void Watch::require_vertices(std::uint64_t vertices) const {
  if (limits_.vertices == 0 || vertices <= limits_.vertices) return;
  fail(Cause::too_large,
       "the answer has {} vertices or more, and Limits::vertices allows {}: ask for a smaller region or a larger "
       "tolerance, or use Question::budget",
       vertices, limits_.vertices);
}

void Watch::stage(const char* name, double from, double to) {
  stage_ = name;
  from_ = from;
  to_ = to;
  tell(0);
}

void Watch::tell(double share) {
  look();
  if (!progress_) return;
  constexpr double kWorthSaying = 1.0 / 256;
  const double fraction = from_ + (to_ - from_) * std::clamp(share, 0.0, 1.0);
  if (fraction < told_ + kWorthSaying && !(fraction >= 1 && told_ < 1)) return;
  told_ = fraction;
  progress_(fraction, stage_);
}

Watch& unwatched() {
  static Watch watch;
  return watch;
}

std::uint64_t bytes_of_mask(GridRect region) {
  const auto words = static_cast<std::uint64_t>((region.cols() + 63) / 64) * static_cast<std::uint64_t>(region.rows());
  return words * (sizeof(std::uint64_t) + sizeof(std::uint32_t));
}

}  // namespace talus
