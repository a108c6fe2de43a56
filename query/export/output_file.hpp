#pragma once
// An output file that appears complete or not at all.

#include <array>
#include <bit>
#include <concepts>
#include <cstddef>
#include <filesystem>
#include <string_view>
#include <utility>
#include <vector>

namespace talus {

/// Collects bytes in another file beside `target`; commit() renames it. Without commit() it is removed, and the old
/// target is unchanged. If `target` is a link, the file it leads to is replaced.
class OutputFile {
 public:
  /// fails  full, io (a folder, a device); names the target
  explicit OutputFile(std::filesystem::path target);
  ~OutputFile();
  OutputFile(const OutputFile&) = delete;
  OutputFile& operator=(const OutputFile&) = delete;

  void write(const void* bytes, std::size_t count);
  void write(std::string_view text) { write(text.data(), text.size()); }
  /// Writes a number, lowest byte first.
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
  /// The file beside the target, for a library that writes it by name. Do not write here then.
  [[nodiscard]] const std::filesystem::path& beside() const { return beside_; }

  /// Makes the file durable and gives it its name.
  void commit();

 private:
  void flush();
  [[noreturn]] void fail(const char* what) const;

  std::filesystem::path target_;  ///< as asked for
  std::filesystem::path place_, beside_;
  int file_ = -1;
  std::vector<char> buffer_;
};

}  // namespace talus
