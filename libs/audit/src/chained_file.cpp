#include "chained_file.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <system_error>

namespace metier::audit {
namespace {

constexpr mode_t kOwnerOnly = 0600;
constexpr off_t kLongestLine = 64 * 1024;  // that is looked at, from the end

tl::unexpected<Error> failed(const std::filesystem::path& path) {
    return fail(Errc::resource_unavailable,
                fmt::format("{}: {}", path.string(), std::generic_category().message(errno)));
}

}  // namespace

Result<std::unique_ptr<AuditLog::File>> AuditLog::File::open(const std::filesystem::path& path,
                                                             std::size_t& dropped) {
    std::error_code ignored;  // open() tells what is wrong
    std::filesystem::create_directories(path.parent_path(), ignored);
    const int descriptor =
        ::open(path.c_str(), O_RDWR | O_CREAT | O_APPEND | O_CLOEXEC, kOwnerOnly);
    if (descriptor < 0) {
        return failed(path);
    }
    std::unique_ptr<File> file(new File(descriptor, path));
    const auto read = file->readEnd();
    if (!read) {
        return fail(read.error());
    }
    dropped = *read;
    return file;
}

AuditLog::File::~File() {
    ::close(descriptor_);
}

/// The number of bytes behind the last whole line, which are cut off.
Result<std::size_t> AuditLog::File::readEnd() {
    const off_t size = ::lseek(descriptor_, 0, SEEK_END);
    if (size < 0) {
        return failed(path_);
    }
    const off_t begin = std::max<off_t>(0, size - kLongestLine);
    std::string tail(static_cast<std::size_t>(size - begin), '\0');
    if (::pread(descriptor_, tail.data(), tail.size(), begin) !=
        static_cast<ssize_t>(tail.size())) {
        return failed(path_);
    }
    const auto end = tail.rfind('\n');
    const auto dropped = end == std::string::npos ? tail.size() : tail.size() - end - 1;
    if (dropped > 0 && ::ftruncate(descriptor_, size - static_cast<off_t>(dropped)) != 0) {
        return failed(path_);
    }
    if (end == std::string::npos || end == 0) {
        return dropped;
    }
    const auto before = tail.rfind('\n', end - 1);
    const auto first = before == std::string::npos ? 0 : before + 1;
    const auto last = readLastLine(std::string_view(tail).substr(first, end - first));
    if (!last) {
        return fail(Errc::invalid_argument,
                    fmt::format("{} is no audit log: its last line is not one", path_.string()));
    }
    number_ = last->number;
    chain_ = last->chain;
    return dropped;
}

Result<void> AuditLog::File::write(const std::vector<Entry>& entries) {
    std::string text;
    auto number = number_;
    auto chain = chain_;
    for (const auto& entry : entries) {
        auto line = chainLine(entry, ++number, chain);
        text += line.text + '\n';
        chain = std::move(line.chain);
    }
    const off_t size = ::lseek(descriptor_, 0, SEEK_END);
    std::string_view rest = text;
    while (!rest.empty()) {
        const auto written = ::write(descriptor_, rest.data(), rest.size());
        if (written < 0 && errno == EINTR) {
            continue;
        }
        if (written <= 0) {
            auto error = failed(path_);
            // What went out of a batch that did not fit would be there twice later.
            return ::ftruncate(descriptor_, size) == 0 ? error : failed(path_);
        }
        rest.remove_prefix(static_cast<std::size_t>(written));
    }
    if (::fdatasync(descriptor_) != 0) {
        return failed(path_);
    }
    number_ = number;
    chain_ = std::move(chain);
    return {};
}

}  // namespace metier::audit
