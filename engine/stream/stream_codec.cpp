// A stream is a header and a part for each level. Each ends with a checksum whose seed is the checksum before it, so a
// part cannot replace another part or come from another stream. A reader compares each count with the bytes that are
// left before it allocates memory. Memory grows with the number of vertices in the header; masks have their own limit.

#include "engine/stream/stream_codec.hpp"

#include <algorithm>
#include <bit>
#include <limits>
#include <optional>
#include <utility>
#include <variant>

#include <fmt/format.h>

#include "engine/quadtree/grid.hpp"
#include "engine/quadtree/merge.hpp"
#include "engine/stream/height_codes.hpp"
#include "engine/stream/stream_bytes.hpp"
#include "engine/stream/stream_header.hpp"
#include "engine/stream/stream_levels.hpp"
#include "talus/failure.hpp"

namespace talus {
namespace {

constexpr std::size_t kFrame = 12;  ///< bytes of a part's length, vertices and checksum

const RestrictedQuadtree& quadtree_of(const Stream& stream) {
  if (const auto* increment = std::get_if<Increment>(&stream.content)) return increment->added;
  return std::get<RestrictedQuadtree>(stream.content);
}

[[noreturn]] void refuse_argument(const std::string& what) { throw Failure(Cause::invalid_argument, what); }

StreamHeader header_of(const Stream& stream, const RestrictedQuadtree* base) {
  const RestrictedQuadtree& q = quadtree_of(stream);
  const auto* increment = std::get_if<Increment>(&stream.content);
  const Description& d = stream.description;
  const std::size_t n = q.vertices.size();
  const auto root_of = [](GridRect r) {
    return static_cast<std::size_t>(std::countr_zero(static_cast<std::uint32_t>(root_side(r))));
  };
  if (q.heights.size() != n || (!q.covers.empty() && q.covers.size() != n) ||
      (!q.level_errors.empty() && q.level_errors.size() != root_of(d.extent) + 1) || q.region.cols() < 1 ||
      q.region.rows() < 1)
    refuse_argument("cannot write a quadtree whose region, heights, covers or level errors do not fit its vertices");
  if (increment != nullptr) {
    if (base == nullptr) refuse_argument("cannot write an increment without the answer that it continues");
    require_fit(*base, *increment);
  }
  StreamHeader h;
  h.description = d;
  h.quadtree.region = q.region;
  h.quadtree.tolerance = q.tolerance;
  h.quadtree.bound = q.bound;
  h.quadtree.origin = q.origin;
  h.quadtree.level_errors = q.level_errors;
  h.window = q.vertices.region();
  h.is_increment = increment != nullptr;
  h.has_covers = !q.covers.empty();
  h.has_loose = h.has_covers || q.origin.border != Border::constrain || (base != nullptr && !base->covers.empty());
  h.from = increment != nullptr ? increment->from : Metres{std::numeric_limits<double>::infinity()};
  h.vertices = n;
  h.parts = 1 + root_of(q.level_errors.empty() ? h.window : d.extent);
  if (base != nullptr) h.base = digest_of(*base);
  return h;
}

template <class Code>
std::vector<EncodedPart> parts_of(const StreamHeader& h, const HeightCoding& coding, const RestrictedQuadtree& q,
                                  const RestrictedQuadtree* base, const StreamOptions& options) {
  const auto codes = codes_of<Code>(coding, q.heights);
  const auto base_codes =
      codes_of<Code>(coding, base != nullptr ? std::span<const double>(base->heights) : std::span<const double>());
  return encode_parts<Code>(h, q, codes.value(), base, base_codes.value(), options);
}

}  // namespace

std::vector<std::byte> encode(const Stream& stream, const StreamOptions& options, const RestrictedQuadtree* base) {
  if (!std::holds_alternative<Increment>(stream.content)) base = nullptr;
  StreamHeader h = header_of(stream, base);
  const RestrictedQuadtree& q = quadtree_of(stream);
  std::vector<std::span<const double>> heights{q.heights};
  if (base != nullptr) heights.push_back(base->heights);
  const HeightCoding coding = HeightCoding::of(h.description, q.origin.quantum, q.tolerance, heights);
  h.kind = coding.kind;
  h.is_wide = coding.is_wide;
  const auto parts = coding.is_wide ? parts_of<std::int64_t>(h, coding, q, base, options)
                                    : parts_of<std::int32_t>(h, coding, q, base, options);
  StreamWriter out;
  put_header(out, h);
  for (const EncodedPart& part : parts) {
    const std::size_t begin = out.bytes.size();
    out.put(static_cast<std::uint32_t>(part.payload.size()));
    out.put(static_cast<std::uint32_t>(part.vertices));
    out.put(std::span<const std::byte>(part.payload));
    out.seal_short(begin);
  }
  return std::move(out.bytes);
}

// ---- reading --------------------------------------------------------------------------------------------

namespace {

struct Frame {
  std::uint32_t vertices = 0;
  std::span<const std::byte> payload;
  std::size_t bytes = 0;
  std::uint64_t seal = 0;
};

/// The next part; empty if bytes are missing. at: its place in the stream.
std::optional<Frame> take_frame(std::span<const std::byte> bytes, std::size_t at, std::uint64_t seed) {
  if (bytes.size() < kFrame) return std::nullopt;
  StreamTaker in(bytes, at);
  const auto length = in.take<std::uint32_t>();
  Frame frame;
  frame.vertices = in.take<std::uint32_t>();
  if (length > bytes.size() - kFrame) return std::nullopt;
  frame.payload = in.take(length);
  frame.bytes = kFrame + length;
  frame.seal = stream_checksum(bytes.first(frame.bytes - 4), seed);
  if (in.take<std::uint32_t>() != static_cast<std::uint32_t>(frame.seal)) StreamTaker::refuse(at, "wrong checksum");
  return frame;
}

/// Adds the byte to the sentence of a failure that lacks it.
template <class Work>
void located(std::size_t at, Work&& work) {
  try {
    work();
  } catch (const Failure& f) {
    const std::string sentence = f.what(), kind = "corrupt: ";
    if (f.cause() != Cause::corrupt || !sentence.starts_with(kind) || sentence.starts_with(kind + "byte ")) throw;
    StreamTaker::refuse(at, sentence.substr(kind.size()));
  }
}

}  // namespace

struct StreamDecoder::State {
  StreamLimits limits;
  const RestrictedQuadtree* base;
  int threads;
  std::vector<std::byte> waiting;
  std::size_t used = 0;  ///< bytes of the stream before `waiting`
  std::optional<StreamHeader> header;
  std::uint64_t seed = 0;
  std::size_t parts = 0;
  std::unique_ptr<PartsDecoder<std::int32_t>> narrow;
  std::unique_ptr<PartsDecoder<std::int64_t>> wide;

  void start() {
    seed = header->seal;
    if (header->is_increment) {
      if (base == nullptr) refuse_argument("cannot read an increment without the answer that it continues");
      Increment increment;
      increment.added = header->quadtree;
      increment.added.vertices = VertexMask(header->window);
      increment.from = header->from;
      require_fit(*base, increment);
      if (digest_of(*base) != header->base)
        refuse_argument("the increment continues another answer: vertices or heights differ");
    } else {
      base = nullptr;
    }
    const HeightCoding coding = HeightCoding::of(*header);
    const auto begin = [&]<class Code>(std::unique_ptr<PartsDecoder<Code>>& decoder) {
      const auto codes =
          codes_of<Code>(coding, base != nullptr ? std::span<const double>(base->heights) : std::span<const double>());
      if (!codes) StreamTaker::refuse(0, "the base has a height that is not a multiple of the step");
      decoder = std::make_unique<PartsDecoder<Code>>(*header, base, *codes, threads);
    };
    header->is_wide ? begin(wide) : begin(narrow);
  }
  /// Decodes the parts that are whole.
  void go_on(std::span<const std::byte> bytes, std::size_t& at) {
    if (!header) {
      header = take_header(bytes, limits);
      if (!header) return;
      at = header->bytes;
      start();
    }
    while (parts < header->parts) {
      const auto frame = take_frame(bytes.subspan(at), used + at, seed);
      if (!frame) return;
      located(used + at, [&] {
        wide ? wide->take(frame->payload, frame->vertices) : narrow->take(frame->payload, frame->vertices);
      });
      seed = frame->seal;
      at += frame->bytes;
      ++parts;
    }
  }
  [[nodiscard]] std::uint64_t vertices() const { return wide ? wide->vertices() : narrow ? narrow->vertices() : 0; }
};

StreamDecoder::StreamDecoder(const StreamLimits& limits, const RestrictedQuadtree* base, int threads)
    : state_(std::make_unique<State>()) {
  state_->limits = limits;
  state_->base = base;
  state_->threads = threads;
}
StreamDecoder::~StreamDecoder() = default;

void StreamDecoder::add(std::span<const std::byte> bytes) {
  State& s = *state_;
  std::size_t at = 0;
  if (s.waiting.empty()) {
    s.go_on(bytes, at);
    s.waiting.assign(bytes.begin() + static_cast<std::ptrdiff_t>(at), bytes.end());
  } else {
    s.waiting.insert(s.waiting.end(), bytes.begin(), bytes.end());
    s.go_on(s.waiting, at);
    s.waiting.erase(s.waiting.begin(), s.waiting.begin() + static_cast<std::ptrdiff_t>(at));
  }
  s.used += at;
  if (s.header && s.parts == s.header->parts) {
    if (!s.waiting.empty()) StreamTaker::refuse(s.used, fmt::format("{} bytes after the last part", s.waiting.size()));
    if (s.vertices() != s.header->vertices)
      StreamTaker::refuse(s.used, fmt::format("{} vertices, but the header says {}", s.vertices(), s.header->vertices));
  }
}

std::size_t StreamDecoder::parts() const { return state_->parts; }
std::size_t StreamDecoder::parts_in_all() const { return state_->header ? state_->header->parts : 0; }
std::size_t StreamDecoder::bytes() const { return state_->used; }
std::uint64_t StreamDecoder::vertices() const { return state_->vertices(); }
Metres StreamDecoder::bound() const { return state_->header->bound(state_->parts - 1); }

void StreamDecoder::require_whole() const {
  const State& s = *state_;
  if (s.header && s.parts == s.header->parts) return;
  StreamTaker::refuse(s.used + s.waiting.size(),
                      s.header ? fmt::format("the stream is cut: {} of {} parts are whole", s.parts, s.header->parts)
                               : "the stream is cut within its header");
}

Stream StreamDecoder::stream() const {
  const State& s = *state_;
  if (s.parts == 0) require_whole();
  const StreamHeader& h = *s.header;
  if (h.quadtree.origin.border != Border::constrain) require_whole();  // only a whole one covers its region
  Stream stream;
  stream.description = h.description;
  RestrictedQuadtree q;
  located(s.used, [&] { q = s.wide ? s.wide->quadtree() : s.narrow->quadtree(); });
  if (h.is_increment) {
    stream.content = Increment{std::move(q), h.from, {}};
  } else {
    stream.content = std::move(q);
  }
  return stream;
}

Stream decode_stream(std::span<const std::byte> bytes, const StreamLimits& limits, const RestrictedQuadtree* base,
                     int threads) {
  StreamDecoder decoder(limits, base, threads);
  decoder.add(bytes);
  decoder.require_whole();
  return decoder.stream();
}

StreamPrefix decode_stream_prefix(std::span<const std::byte> bytes, const StreamLimits& limits,
                                  const RestrictedQuadtree* base) {
  StreamDecoder decoder(limits, base);
  decoder.add(bytes);
  StreamPrefix prefix;
  prefix.stream = decoder.stream();
  prefix.parts = decoder.parts();
  prefix.parts_in_all = decoder.parts_in_all();
  prefix.bytes = decoder.bytes();
  return prefix;
}

StreamInfo stream_info(std::span<const std::byte> bytes, const StreamLimits& limits) {
  const auto h = take_header(bytes, limits);
  if (!h) StreamTaker::refuse(bytes.size(), "the stream is cut within its header");
  StreamInfo info;
  info.description = h->description;
  info.region = h->quadtree.region;
  info.origin = h->quadtree.origin;
  info.is_increment = h->is_increment;
  info.from = h->from;
  info.tolerance = h->quadtree.tolerance;
  info.bound = h->quadtree.bound;
  info.vertices = h->vertices;
  info.bytes = bytes.size();
  info.header_bytes = h->bytes;
  std::size_t at = h->bytes;
  std::uint64_t seed = h->seal;
  for (std::size_t i = 0; i < h->parts; ++i) {
    const auto frame = take_frame(bytes.subspan(at), at, seed);
    if (!frame)
      StreamTaker::refuse(bytes.size(), fmt::format("the stream is cut: {} of {} parts are whole", i, h->parts));
    info.parts.push_back({frame->vertices, frame->bytes, h->bound(i)});
    at += frame->bytes;
    seed = frame->seal;
  }
  if (at != bytes.size()) StreamTaker::refuse(at, fmt::format("{} bytes after the last part", bytes.size() - at));
  return info;
}

}  // namespace talus
