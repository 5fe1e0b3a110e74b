// A log of the results of batches, one record after the other:
//
//   head: key of the batch, bytes of its answers, blocks, checksum | answers | one byte per block
//
// A run overwrites the record of its unfinished batch with its next record. Records of finished
// batches stay. An unfinished record of an earlier run stays until this run takes up its batch.
#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cstring>
#include <optional>
#include <vector>

#include "io/block_format.h"
#include "raysheaf/block_file.h"
#include "raysheaf/error.h"

namespace raysheaf {
namespace {

using Clock = std::chrono::steady_clock;

struct RecordHead {
  std::uint64_t key, answer_bytes, blocks, whole, checksum;  ///< `checksum`: of the bytes after it
};

struct Record {
  RecordHead head;
  std::uint64_t offset;  ///< of the bytes that follow the head
};

std::span<const std::uint8_t> as_uint8(std::span<const std::byte> bytes) {
  return {reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size()};
}

}  // namespace

struct CheckpointFile::Impl {
  std::string path, subject;
  double seconds = 1;
  int file = -1;
  std::uint64_t end = 0;  ///< where the records that stay end
  std::vector<Record> records;
  Clock::time_point last = Clock::now();
  double wait = 0;                     ///< seconds until the next write
  std::optional<std::uint32_t> begun;  ///< the batch that was written last

  [[noreturn]] void fail(const char* verb) const { throw io::system_error(verb, path, errno); }

  /// Opens an existing file. The file is created only when there is something to store, so that a
  /// refused frame leaves none behind.
  void open(int flags) {
    file = ::open(path.c_str(), O_RDWR | O_CLOEXEC | flags, 0666);
    if (file >= 0) return;
    if (errno != ENOENT || flags != 0) fail("opened");
    // The file does not exist yet; check that it can be created later.
    if (::access(io::folder_of(path).c_str(), W_OK | X_OK) != 0) fail("opened");
  }
  bool read(std::uint64_t offset, void* out, std::uint64_t size) const {
    auto* to = static_cast<char*>(out);
    while (size > 0) {
      const ssize_t got = ::pread(file, to, size, static_cast<off_t>(offset));
      if (got < 0 && errno == EINTR) continue;
      if (got < 0) fail("read");
      if (got == 0) return false;
      to += got;
      offset += static_cast<std::uint64_t>(got);
      size -= static_cast<std::uint64_t>(got);
    }
    return true;
  }
  void write(std::uint64_t offset, const void* from, std::uint64_t size) const {
    const auto* at = static_cast<const char*>(from);
    while (size > 0) {
      const ssize_t put = ::pwrite(file, at, size, static_cast<off_t>(offset));
      if (put < 0 && errno == EINTR) continue;
      if (put < 0) fail("written");
      at += put;
      offset += static_cast<std::uint64_t>(put);
      size -= static_cast<std::uint64_t>(put);
    }
  }

  /// Finds the records by their heads.
  void find_records() {
    const off_t size = ::lseek(file, 0, SEEK_END);
    if (size < 0) fail("read");
    const auto bytes = static_cast<std::uint64_t>(size);
    Record record{};
    for (std::uint64_t at = 0; read(at, &record.head, sizeof(RecordHead));) {
      record.offset = at + sizeof(RecordHead);
      const std::uint64_t room = bytes - record.offset;
      if (record.head.answer_bytes > room || record.head.blocks > room - record.head.answer_bytes)
        break;
      records.push_back(record);
      at = end = record.offset + record.head.answer_bytes + record.head.blocks;
    }
  }

  [[nodiscard]] std::uint64_t key_of(const StreamBatch& batch) const {
    std::vector<std::uint64_t> parts = {batch.number,
                                        batch.question,
                                        batch.part,
                                        batch.parts,
                                        io::checksum(io::as_bytes(subject)),
                                        io::checksum(as_uint8(std::as_bytes(batch.rays)))};
    for (const BlockInfo& block : batch.blocks) {
      parts.push_back(io::checksum(io::bytes_of(block.bounds)));
      parts.insert(parts.end(), {block.triangles, block.geometry_bytes, block.shading_bytes});
    }
    return io::checksum(as_uint8(std::as_bytes(std::span(parts))));
  }

  [[nodiscard]] bool is_whole(std::uint64_t key) const {
    return std::any_of(records.begin(), records.end(), [key](const Record& record) {
      return record.head.key == key && record.head.whole != 0;
    });
  }

  /// The record's bytes after the head; empty if they are damaged or incomplete.
  [[nodiscard]] std::vector<std::uint8_t> bytes_of(const Record& record) const {
    std::vector<std::uint8_t> bytes(record.head.answer_bytes + record.head.blocks);
    const bool good = read(record.offset, bytes.data(), bytes.size()) &&
                      io::checksum(bytes) == record.head.checksum;
    return good ? bytes : std::vector<std::uint8_t>{};
  }
};

CheckpointFile::CheckpointFile(std::string path, std::string subject, double seconds)
    : impl_(std::make_unique<Impl>()) {
  impl_->path = std::move(path);
  impl_->subject = std::move(subject);
  impl_->seconds = impl_->wait = seconds;
  impl_->open(0);
  try {
    if (impl_->file >= 0) impl_->find_records();
  } catch (...) {
    ::close(impl_->file);
    throw;
  }
}

CheckpointFile::~CheckpointFile() {
  if (impl_->file >= 0) ::close(impl_->file);
}

bool CheckpointFile::restore(const StreamBatch& batch, std::span<std::byte> answers,
                             std::span<std::uint8_t> done) {
  const std::uint64_t key = impl_->key_of(batch);
  std::vector<Record>& records = impl_->records;
  // The last record has the newest results: each run continues the record of the run before.
  for (std::size_t i = records.size(); i-- > 0;) {
    const Record record = records[i];
    if (record.head.key != key || record.head.answer_bytes != answers.size() ||
        record.head.blocks != done.size())
      continue;
    const std::vector<std::uint8_t> bytes = impl_->bytes_of(record);
    if (bytes.empty() && !(answers.empty() && done.empty())) {
      records[i].head.whole = 0;  // the record is damaged: the batch is stored again
      continue;
    }
    std::memcpy(answers.data(), bytes.data(), answers.size());
    std::memcpy(done.data(), bytes.data() + answers.size(), done.size());
    if (record.head.whole != 0) return true;
    impl_->begun = batch.number;
    if (i + 1 == records.size() && record.offset + bytes.size() == impl_->end)
      impl_->end = record.offset - sizeof(RecordHead);
    return true;
  }
  return false;
}

void CheckpointFile::keep(const StreamBatch& batch, std::span<const std::byte> answers,
                          std::span<const std::uint8_t> done, bool whole) {
  const Clock::time_point start = Clock::now();
  const std::chrono::duration<double> since = start - impl_->last;
  // If a partial record of the batch was written, the finished batch is always stored: the next
  // batch's record would overwrite the partial one.
  if (since.count() < impl_->wait && !(whole && impl_->begun == batch.number)) return;
  const std::uint64_t key = impl_->key_of(batch);
  if (impl_->is_whole(key)) return;
  std::vector<std::uint8_t> bytes(answers.size() + done.size());
  std::memcpy(bytes.data(), answers.data(), answers.size());
  std::memcpy(bytes.data() + answers.size(), done.data(), done.size());
  if (impl_->file < 0) impl_->open(O_CREAT);
  const RecordHead head{key, answers.size(), done.size(), whole ? 1u : 0u, io::checksum(bytes)};
  impl_->write(impl_->end + sizeof head, bytes.data(), bytes.size());
  impl_->write(impl_->end, &head, sizeof head);
  const std::uint64_t end = impl_->end + sizeof head + bytes.size();
  if (::ftruncate(impl_->file, static_cast<off_t>(end)) != 0) impl_->fail("written");
  if (whole) impl_->end = end;
  impl_->begun = batch.number;
  impl_->last = Clock::now();
  const std::chrono::duration<double> took = impl_->last - start;
  impl_->wait = std::max(impl_->seconds, 50 * took.count());
}

void CheckpointFile::remove() {
  ::unlink(impl_->path.c_str());
}

}  // namespace raysheaf
