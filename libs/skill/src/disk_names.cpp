#include "disk_names.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <fstream>
#include <string_view>
#include <utility>

namespace metier::skill {

namespace {

constexpr int kPrivate = 0600;

std::filesystem::path oldOf(const std::filesystem::path& file) {
    return file.string() + ".old";
}

Result<void> refusedBySystem(const std::filesystem::path& file, std::string_view doing) {
    return fail(Errc::resource_unavailable,
                fmt::format("{}: cannot {}: {}", file.string(), doing, std::strerror(errno)));
}

struct Lines {
    std::unordered_set<std::string> whole;
    std::uintmax_t size = 0;  ///< size of the complete lines [byte]
};

/// A line without end was cut off by a crash: its execution has not begun.
Lines readLines(const std::filesystem::path& file) {
    std::ifstream stream(file, std::ios::binary);
    Lines lines;
    std::string line;
    while (std::getline(stream, line) && !stream.eof()) {
        lines.size += line.size() + 1;
        lines.whole.insert(line);
    }
    return lines;
}

}  // namespace

Result<std::unique_ptr<DiskNames>> DiskNames::open(const std::filesystem::path& file,
                                                   Known& known) {
    std::error_code error;
    if (file.has_parent_path()) {
        std::filesystem::create_directories(file.parent_path(), error);
    }
    std::unique_ptr<DiskNames> names(new DiskNames(file));
    METIER_TRY(names->openFile());
    auto lines = readLines(file);
    known = {std::move(lines.whole), readLines(oldOf(file)).whole};
    names->size_ = lines.size;
    if (::ftruncate(names->descriptor_, static_cast<off_t>(lines.size)) != 0) {
        return fail(refusedBySystem(file, "mend it").error());
    }
    return names;
}

DiskNames::~DiskNames() {
    closeFile();
}

void DiskNames::closeFile() {
    if (descriptor_ >= 0) {
        ::close(std::exchange(descriptor_, -1));
    }
    size_ = 0;
}

/// The lock ends with the process, however that ends.
Result<void> DiskNames::openFile() {
    descriptor_ = ::open(file_.c_str(), O_RDWR | O_CREAT | O_APPEND | O_CLOEXEC, kPrivate);
    if (descriptor_ < 0) {
        return refusedBySystem(file_, "open it");
    }
    if (::flock(descriptor_, LOCK_EX | LOCK_NB) != 0) {
        return refusedBySystem(file_, "have it alone");
    }
    return {};
}

Result<void> DiskNames::append(const std::string& line) {
    const auto written = ::write(descriptor_, line.data(), line.size());
    if (written == static_cast<ssize_t>(line.size())) {
        size_ += line.size();
        return {};
    }
    auto refused = refusedBySystem(file_, "note a start");
    // Part of a line would swallow the next one. If this fails, too, no execution has begun.
    if (written > 0 && ::ftruncate(descriptor_, static_cast<off_t>(size_)) != 0) {
        return refusedBySystem(file_, "take back a part of a line");
    }
    return refused;
}

Result<void> DiskNames::beginAnew() {
    std::error_code error;
    if (std::filesystem::exists(file_)) {
        std::filesystem::rename(file_, oldOf(file_), error);
    }
    if (error) {
        return fail(Errc::resource_unavailable,
                    fmt::format("{}: cannot begin it anew: {}", file_.string(), error.message()));
    }
    closeFile();
    return openFile();
}

}  // namespace metier::skill
