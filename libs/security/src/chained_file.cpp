#include "chained_file.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>

#include "parts.hpp"

namespace metier::security {
namespace {

constexpr mode_t kPartMode = 0600;
constexpr off_t kLongestLine = 65'536;  // length examined from the end of the file

Descriptor openPart(const std::filesystem::path& path) {
    return Descriptor(::open(path.c_str(), O_RDWR | O_CREAT | O_APPEND | O_CLOEXEC, kPartMode));
}

/// End of a part.
struct End {
    std::optional<ReadLine> line;  ///< none: the part is empty
    std::size_t dropped = 0;       ///< [byte] cut off behind it
};

/// Cuts off the bytes behind the last whole line.
Result<End> readEnd(const Descriptor& part, const std::filesystem::path& path) {
    const off_t size = ::lseek(part.get(), 0, SEEK_END);
    if (size < 0) {
        return failed(path);
    }
    const off_t begin = std::max<off_t>(0, size - kLongestLine);
    std::string tail(static_cast<std::size_t>(size - begin), '\0');
    if (::pread(part.get(), tail.data(), tail.size(), begin) != static_cast<ssize_t>(tail.size())) {
        return failed(path);
    }
    const auto end = tail.rfind('\n');
    const auto dropped = end == std::string::npos ? tail.size() : tail.size() - end - 1;
    if (dropped > 0 && ::ftruncate(part.get(), size - static_cast<off_t>(dropped)) != 0) {
        return failed(path);
    }
    if (end == std::string::npos || end == 0) {
        return End{{}, dropped};
    }
    const auto before = tail.rfind('\n', end - 1);
    const auto first = before == std::string::npos ? 0 : before + 1;
    auto last = readLastLine(std::string_view(tail).substr(first, end - first));
    if (!last) {
        return fail(Errc::invalid_argument,
                    fmt::format("{} is no audit log: its last line is not one", path.string()));
    }
    return End{std::move(last), dropped};
}

}  // namespace

Result<std::unique_ptr<AuditLog::File>> AuditLog::File::open(const std::filesystem::path& path,
                                                             std::uintmax_t part_size,
                                                             std::size_t& dropped) {
    static_cast<void>(makeFolder(path.parent_path()));  // to open the file reports the error
    std::unique_ptr<File> file(new File(path, part_size));
    METIER_TRY(file->lock());
    METIER_ASSIGN(const auto read, file->readEnds());
    dropped = read;
    return file;
}

Result<void> AuditLog::File::lock() {
    first_part_ = openPart(log_);
    if (!first_part_) {
        return failed(log_);
    }
    if (::flock(first_part_.get(), LOCK_EX | LOCK_NB) == 0) {
        return {};
    }
    return errno == EWOULDBLOCK
               ? fail(Errc::resource_unavailable,
                      fmt::format("{} is written by another server", log_.string()))
               : failed(log_);
}

/// The number of bytes that were cut off.
Result<std::size_t> AuditLog::File::readEnds() {
    part_number_ = lastPart(log_);
    part_ = openPart(partOf(log_, part_number_));
    if (!part_) {
        return failed(partOf(log_, part_number_));
    }
    auto end = readEnd(part_, partOf(log_, part_number_));
    const auto dropped = end ? end->dropped : 0;
    // A part is made before its first line is written.
    for (auto before = part_number_ - 1; end && !end->line && before > 0; --before) {
        const auto path = partOf(log_, before);
        const auto part = openPart(path);
        end = part ? readEnd(part, path) : Result<End>(failed(path));
    }
    if (!end) {
        return fail(end.error());
    }
    if (end->line) {
        number_ = end->line->number;
        chain_ = end->line->chain;
    }
    return dropped;
}

/// Stays in this part if it cannot.
void AuditLog::File::goOnInNextPart(off_t size) {
    if (static_cast<std::uintmax_t>(size) < part_size_) {
        return;
    }
    if (auto next = openPart(partOf(log_, part_number_ + 1))) {
        part_ = std::move(next);
        ++part_number_;
    }
}

AuditLog::File::Batch AuditLog::File::chained(const std::vector<Entry>& entries,
                                              bool at_begin) const {
    Batch batch{{}, number_, chain_};
    const auto add = [&](const Entry& entry) {
        auto line = chainLine(entry, ++batch.number, batch.chain);
        batch.text += line.text + '\n';
        batch.chain = std::move(line.chain);
    };
    if (at_begin && number_ > 0) {
        add({std::chrono::system_clock::now(),
             std::string(kContinued),
             {{std::string(kAfter), chain_}}});
    }
    std::for_each(entries.begin(), entries.end(), add);
    return batch;
}

Result<void> AuditLog::File::write(const std::vector<Entry>& entries) {
    goOnInNextPart(::lseek(part_.get(), 0, SEEK_END));
    const off_t size = ::lseek(part_.get(), 0, SEEK_END);
    const auto path = partOf(log_, part_number_);
    auto batch = chained(entries, size == 0);
    // The written part of a failed batch is removed; otherwise it would be in the file twice later.
    const auto undone = [&] {
        auto error = failed(path);
        return ::ftruncate(part_.get(), size) == 0 ? error : failed(path);
    };
    if (!writeAll(part_, batch.text) || ::fdatasync(part_.get()) != 0) {
        return undone();
    }
    number_ = batch.number;
    chain_ = std::move(batch.chain);
    return {};
}

}  // namespace metier::security
