#include "ingest/mosaic/input_files.hpp"

#include <algorithm>
#include <chrono>
#include <ctime>
#include <set>

#include <fmt/chrono.h>
#include <fmt/format.h>

#include "engine/machine/fail.hpp"
#include "storage/checksum.hpp"

namespace talus {
namespace {

namespace fs = std::filesystem;

bool is_young(const FileState& state) {
  constexpr std::int64_t kCoarsest = 2'000'000'000;  // ns: the coarsest times of any file system
  const auto now = std::chrono::system_clock::now().time_since_epoch();
  const std::int64_t now_ns = std::chrono::duration_cast<std::chrono::nanoseconds>(now).count();
  return std::max(state.modified_ns, state.changed_ns) > now_ns - kCoarsest;
}

DigestedFile digested(const FileState& file, const std::function<void()>& tell) {
  const bool young = is_young(file);
  const std::uint64_t digest = checksum_of_file(file.file, tell);
  return {file, young, digest};
}

}  // namespace

std::string difference_of(const DigestedFile& then, const DigestedFile& now) {
  if (then.state.bytes != now.state.bytes)
    return fmt::format("has {} bytes, had {}", now.state.bytes, then.state.bytes);
  if (then.digest == now.digest) return "";
  const std::time_t when = now.state.modified_ns / 1'000'000'000;
  std::tm local{};
  ::localtime_r(&when, &local);
  return fmt::format("has other content, written {:%Y-%m-%d %H:%M:%S}", local);
}

InputFiles::InputFiles(const Source& source, const std::vector<DigestedFile>& known, const std::function<void()>& tell)
    : source_(&source) {
  std::unordered_map<std::string, const DigestedFile*> vouched;
  for (const DigestedFile& file : known) {
    if (!file.is_young) vouched.emplace(file.state.file.string(), &file);
  }
  std::unordered_map<std::string, std::size_t> found;
  for (const InputFile& input : source.inputs()) {
    std::vector<std::size_t>& own = of_input_.emplace_back();
    for (const FileState& file : input.files) {
      const auto [at, is_new] = found.try_emplace(file.file.string(), files_.size());
      own.push_back(at->second);
      if (!is_new) continue;
      const auto before = vouched.find(at->first);
      const bool is_known = before != vouched.end() && before->second->state == file;
      files_.push_back(is_known ? *before->second : digested(file, tell));
      if (is_known) continue;
      if (state_now(file) != file) fail(file, "was written to");  // it may have had another header
    }
  }
}

std::uint64_t InputFiles::checksum(std::size_t input) const {
  const std::vector<std::size_t>& own = of_input_.at(input);
  if (own.size() == 1) return files_[own.front()].digest;
  std::vector<std::uint64_t> digests;
  for (const std::size_t i : own) digests.push_back(files_[i].digest);
  return checksum_of(digests);
}

void InputFiles::fail(const FileState& file, const std::string& what) {
  is_changed_ = true;
  fail_in(file.file, Cause::io, "{}: changed while it was read: it {}. Start again when nothing writes to the inputs",
          file.file.string(), what);
}

FileState InputFiles::state_now(const FileState& then) {
  try {
    return state_of(then.file);
  } catch (const Failure& f) {
    if (f.cause() == Cause::not_found) fail(then, "was removed");
    throw;
  }
}

void InputFiles::look_again(DigestedFile& file, bool trusts_young, const std::function<void()>& tell) {
  const FileState now = state_now(file.state);
  if (now == file.state && (trusts_young || !file.is_young)) return;
  if (now.bytes != file.state.bytes) fail(file.state, difference_of(file, {now, false, 0}));
  const DigestedFile again = digested(now, tell);
  if (again.digest != file.digest) fail(file.state, difference_of(file, again));
  file.state = now;
  file.is_young = file.is_young || again.is_young;
}

void InputFiles::require_unchanged(GridRect part) {
  const std::vector<InputFile>& inputs = source_->inputs();
  for (std::size_t i = 0; i < inputs.size(); ++i) {
    const GridRect& place = inputs[i].place;
    if (place.first.col > part.last.col || place.last.col < part.first.col || place.first.row > part.last.row ||
        place.last.row < part.first.row) {
      continue;
    }
    for (const std::size_t file : of_input_[i]) look_again(files_[file], true, [] {});
  }
}

void InputFiles::require_unchanged(const std::function<void()>& tell) {
  for (DigestedFile& file : files_) look_again(file, false, tell);
  for (std::size_t i = 0; i < of_input_.size(); ++i) {
    const std::vector<FileState> now = source_->files_now(i);
    std::set<fs::path> then, found;
    for (const std::size_t file : of_input_[i]) then.insert(files_[file].state.file);
    for (const FileState& file : now) {
      if (!then.contains(file.file)) fail(file, "is a new file");
      found.insert(file.file);
    }
    for (const std::size_t file : of_input_[i]) {
      if (!found.contains(files_[file].state.file)) fail(files_[file].state, "is no longer part of the input");
    }
    tell();
  }
}

}  // namespace talus
