#include <algorithm>
#include <cctype>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <string>
#include <system_error>
#include <vector>

#include <fmt/format.h>

#include "engine/stream_codec.hpp"
#include "query/export/output_file.hpp"
#include "talus/failure.hpp"
#include "talus/stream.hpp"

namespace talus {
namespace {

std::vector<std::byte> bytes_of(const std::filesystem::path& file) {
  std::error_code code;
  const auto size = std::filesystem::file_size(file, code);
  if (code) {
    throw Failure(code == std::errc::no_such_file_or_directory ? Cause::not_found : Cause::io,
                  fmt::format("cannot read {}: {}", file.string(), code.message()));
  }
  std::ifstream in(file, std::ios::binary);
  std::vector<std::byte> bytes(size);
  in.read(reinterpret_cast<char*>(bytes.data()), static_cast<std::streamsize>(size));
  if (!in) throw Failure(Cause::io, fmt::format("cannot read {}: {}", file.string(), std::strerror(errno)));
  return bytes;
}

}  // namespace

bool is_stream_file(const std::filesystem::path& file) {
  std::string ending = file.extension().string();
  std::transform(ending.begin(), ending.end(), ending.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return ending == ".rqt";
}

void write_stream(const Stream& stream, const std::filesystem::path& file, const StreamOptions& options,
                  const RestrictedQuadtree* base) {
  if (!is_stream_file(file)) {
    throw Failure(Cause::invalid_argument,
                  fmt::format("cannot write a restricted quadtree to {}: the name must end in .rqt", file.string()));
  }
  const std::vector<std::byte> bytes = encode(stream, options, base);
  OutputFile out{file};
  out.write(bytes.data(), bytes.size());
  out.commit();
}

namespace {

/// What work(bytes) makes of a file's bytes; what it throws names the file.
template <class Work>
auto of_file(const std::filesystem::path& file, Work&& work) {
  const std::vector<std::byte> bytes = bytes_of(file);
  try {
    return work(bytes);
  } catch (const Failure& f) {
    const std::string sentence = f.what(), kind = "corrupt: ";
    throw Failure(f.cause(), sentence.starts_with(kind)
                                 ? fmt::format("{}{}: {}", kind, file.string(), sentence.substr(kind.size()))
                                 : fmt::format("{}: {}", file.string(), sentence));
  }
}

}  // namespace

Stream read_stream(const std::filesystem::path& file, const StreamLimits& limits, const RestrictedQuadtree* base, int threads) {
  return of_file(file, [&](std::span<const std::byte> bytes) { return decode_stream(bytes, limits, base, threads); });
}

StreamInfo read_stream_info(const std::filesystem::path& file, const StreamLimits& limits) {
  return of_file(file, [&](std::span<const std::byte> bytes) { return stream_info(bytes, limits); });
}

}  // namespace talus
