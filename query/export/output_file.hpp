#pragma once
// A file that appears whole or not at all.

#include <array>
#include <bit>
#include <concepts>
#include <cstddef>
#include <filesystem>
#include <string_view>
#include <utility>
#include <vector>

namespace talus {

/// Collects bytes in a file of another name beside `target`; commit() gives it its name. Leaving
/// without commit() removes it, and what stood under the name before is untouched. A link is followed: what it leads to
/// is replaced.
class OutputFile {
 public:
  /// fails  full, io (a folder, a device); the sentence names the target
  explicit OutputFile(std::filesystem::path target);
  ~OutputFile();
  OutputFile(const OutputFile&) = delete;
  OutputFile& operator=(const OutputFile&) = delete;

  void write(const void* bytes, std::size_t count);
  void write(std::string_view text) { write(text.data(), text.size()); }
  /// A number's bytes, lowest first.
  template <class T>
  requires std::integral<T> || std::floating_point<T>
  void write_little_endian(T number) {
    auto bytes = std::bit_cast<std::array<std::byte, sizeof(T)>>(number);
    if constexpr (std::endian::native == std::endian::big) {
      for (std::size_t i = 0; i < sizeof(T) / 2; ++i) std::swap(bytes[i], bytes[sizeof(T) - 1 - i]);
    }
    write(bytes.data(), sizeof(T));
  }

  [[nodiscard]] const std::filesystem::path& target() const { return target_; }
  /// The file beside the target, for a library that writes it by name; nothing is to be written here then.
  [[nodiscard]] const std::filesystem::path& beside() const { return beside_; }

  /// On the disk and under its name when this returns.
  void commit();

 private:
  void flush();
  [[noreturn]] void fail(const char* what) const;

  std::filesystem::path target_;  ///< as it was asked for
  std::filesystem::path place_, beside_;
  int file_ = -1;
  std::vector<char> buffer_;
};

}  // namespace talus
