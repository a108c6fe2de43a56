#include <algorithm>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <string>
#include <system_error>
#include <vector>

#include <fmt/format.h>

#include "engine/machine/fail.hpp"
#include "engine/stream/stream_codec.hpp"
#include "engine/stream/stream_header.hpp"
#include "query/export/output_file.hpp"
#include "query/export/writers.hpp"
#include "talus/stream.hpp"

namespace talus {
namespace {

constexpr std::uintmax_t kFirstBytes = 4096;  // enough to recognize a stream

std::vector<std::byte> bytes_of(const std::filesystem::path& file) {
  std::error_code code;
  const std::filesystem::file_status there = std::filesystem::status(file, code);
  if (!std::filesystem::exists(there)) {
    fail_in(file, code && code != std::errc::no_such_file_or_directory ? Cause::io : Cause::not_found,
            "cannot read {}: {}", file.string(), code ? code.message() : "there is no such file");
  }
  if (!std::filesystem::is_regular_file(there)) {
    fail_in(file, Cause::io, "cannot read {}: it is {}", file.string(),
            std::filesystem::is_directory(there) ? "a folder" : "a device, a pipe or a socket, not a file");
  }
  std::ifstream in(file, std::ios::binary);
  std::vector<std::byte> bytes(std::min(kFirstBytes, std::filesystem::file_size(file)));
  const auto read = [&](std::size_t from) {
    in.read(reinterpret_cast<char*>(bytes.data() + from), static_cast<std::streamsize>(bytes.size() - from));
    if (!in) fail_in(file, Cause::io, "cannot read {}: {}", file.string(), std::strerror(errno));
  };
  read(0);
  if (!begins_as_stream(bytes)) return bytes;  // not a stream, however large
  const std::size_t first = bytes.size();
  bytes.resize(std::filesystem::file_size(file));
  read(first);
  return bytes;
}

}  // namespace

bool is_stream_file(const std::filesystem::path& file) { return ending_of(file) == ".rqt"; }

void write_stream(const Stream& stream, const std::filesystem::path& file, const StreamOptions& options,
                  const RestrictedQuadtree* base) {
  if (!is_stream_file(file))
    fail_in(file, Cause::invalid_argument, "cannot write a stream to {}: the name must end in .rqt", file.string());
  within_memory([&] {
    const std::vector<std::byte> bytes = encode(stream, options, base);
    OutputFile out{file};
    out.write(bytes.data(), bytes.size());
    out.commit();
  });
}

namespace {

/// Returns work(bytes of the file). Its failures name the file.
template <class Work>
auto of_file(const std::filesystem::path& file, Work&& work) {
  const std::vector<std::byte> bytes = bytes_of(file);
  try {
    return within_memory([&] { return work(bytes); });
  } catch (const Failure& f) {
    const std::string sentence = f.what(), kind = "corrupt: ";
    throw Failure(f.cause(),
                  sentence.starts_with(kind)
                      ? fmt::format("{}{}: {}", kind, file.string(), sentence.substr(kind.size()))
                      : fmt::format("{}: {}", file.string(), sentence),
                  file);
  }
}

/// Limits for reading a file of `bytes` bytes.
StreamLimits limits_of(StreamLimits limits, std::uint64_t bytes) {
  constexpr std::uint64_t kAnyMask = std::uint64_t{64} << 20, kAnyVertices = 1'000'000;
  const auto times = [](std::uint64_t a, std::uint64_t b) {
    return b != 0 && a > ~std::uint64_t{0} / b ? ~std::uint64_t{0} : a * b;
  };
  limits.mask_bytes = std::min(limits.mask_bytes, std::max(kAnyMask, times(limits.mask_bytes_a_byte, bytes)));
  limits.vertices = std::min(limits.vertices, std::max(kAnyVertices, times(limits.vertices_a_byte, bytes)));
  return limits;
}

}  // namespace

Stream read_stream(const std::filesystem::path& file, const StreamLimits& limits, const RestrictedQuadtree* base,
                   int threads) {
  return of_file(file, [&](std::span<const std::byte> bytes) {
    return decode_stream(bytes, base != nullptr ? limits : limits_of(limits, bytes.size()), base, threads);
  });
}

StreamInfo read_stream_info(const std::filesystem::path& file, const StreamLimits& limits) {
  return of_file(file, [&](std::span<const std::byte> bytes) { return stream_info(bytes, limits); });
}

}  // namespace talus
