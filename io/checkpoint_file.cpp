// A log of the results of batches, one record after the other:
//
//   head: key of the batch, bytes of its answers, blocks, checksum | answers | one byte per block
//
// A run overwrites the record of its unfinished batch with its next record. Records of finished
// batches stay. An unfinished record of an earlier run stays until this run takes up its batch.
#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cstring>
#include <optional>
#include <vector>

#include "io/block_format.h"
#include "io/file_parts.h"
#include "raysheaf/block_file.h"
#include "raysheaf/error.h"
#include "system/files.h"

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

std::span<std::uint8_t> head_bytes(RecordHead* head) {
  return {reinterpret_cast<std::uint8_t*>(head), sizeof *head};
}

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
  void open() {
    file = system::open_file(path, system::Access::kUpdate);
    if (file >= 0) return;
    // If the file does not exist yet, check that it can be created later.
    if (errno != ENOENT || !system::can_make_files_in(io::folder_of(path))) fail("opened");
  }
  void make() {
    file = system::open_or_make_file(path);
    if (file < 0) fail("opened");
  }
  bool read(std::uint64_t offset, std::span<std::uint8_t> out) const {
    while (!out.empty()) {
      const std::int64_t got = system::read_some(file, offset, out);
      if (got < 0) fail("read");
      if (got == 0) return false;
      out = out.subspan(static_cast<std::size_t>(got));
      offset += static_cast<std::uint64_t>(got);
    }
    return true;
  }
  void write(std::uint64_t offset, std::span<const std::uint8_t> bytes) const {
    io::write_at(file, offset, bytes, path);
  }

  /// Finds the records by their heads.
  void find_records() {
    const auto state = system::state_of(file);
    if (!state) fail("read");
    const std::uint64_t bytes = state->bytes;
    Record record{};
    for (std::uint64_t at = 0; read(at, head_bytes(&record.head));) {
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
    const bool good = read(record.offset, bytes) && io::checksum(bytes) == record.head.checksum;
    return good ? bytes : std::vector<std::uint8_t>{};
  }
};

CheckpointFile::CheckpointFile(std::string path, std::string subject, double seconds)
    : impl_(std::make_unique<Impl>()) {
  impl_->path = std::move(path);
  impl_->subject = std::move(subject);
  impl_->seconds = impl_->wait = seconds;
  impl_->open();
  try {
    if (impl_->file >= 0) impl_->find_records();
  } catch (...) {
    static_cast<void>(system::close_file(impl_->file));
    throw;
  }
}

CheckpointFile::~CheckpointFile() {
  if (impl_->file >= 0) static_cast<void>(system::close_file(impl_->file));
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
  if (impl_->file < 0) impl_->make();
  RecordHead head{key, answers.size(), done.size(), whole ? 1u : 0u, io::checksum(bytes)};
  impl_->write(impl_->end + sizeof head, bytes);
  impl_->write(impl_->end, head_bytes(&head));
  const std::uint64_t end = impl_->end + sizeof head + bytes.size();
  if (!system::resize_file(impl_->file, end)) impl_->fail("written");
  if (whole) impl_->end = end;
  impl_->begun = batch.number;
  impl_->last = Clock::now();
  const std::chrono::duration<double> took = impl_->last - start;
  impl_->wait = std::max(impl_->seconds, 50 * took.count());
}

void CheckpointFile::remove() {
  system::remove_file(impl_->path);
}

}  // namespace raysheaf
