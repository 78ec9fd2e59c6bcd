#include "private_file.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <system_error>

#include "openssl.hpp"

namespace metier::security {
namespace {

constexpr mode_t kOwnerOnly = 0600;
constexpr mode_t kEverybody = 0644;
constexpr mode_t kOthers = 077;

Result<void> checkReaders(const std::filesystem::path& file) {
    struct stat found {};
    if (::stat(file.c_str(), &found) != 0) {
        return fail(Errc::not_found, fmt::format("no such file: {}", file.string()));
    }
    if ((found.st_mode & kOthers) != 0) {
        return fail(Errc::access_denied,
                    fmt::format("{} may be read by others (mode {:03o}, must be 600)",
                                file.string(), found.st_mode & 0777U));
    }
    return {};
}

}  // namespace

Descriptor::~Descriptor() {
    if (value_ >= 0) {
        ::close(value_);
    }
}

tl::unexpected<Error> failed(const std::filesystem::path& file, int error) {
    return fail(Errc::resource_unavailable,
                fmt::format("{}: {}", file.string(), std::generic_category().message(error)));
}

Result<void> makeFolder(const std::filesystem::path& folder) {
    std::error_code error;
    const bool made = std::filesystem::create_directories(folder, error);
    if (!error && made) {
        std::filesystem::permissions(folder, std::filesystem::perms::owner_all, error);
    }
    return error ? failed(folder, error.value()) : Result<void>();
}

bool writeAll(const Descriptor& file, std::string_view content) {
    while (!content.empty()) {
        const auto written = ::write(file.get(), content.data(), content.size());
        if (written < 0 && errno == EINTR) {
            continue;
        }
        if (written <= 0) {
            return false;
        }
        content.remove_prefix(static_cast<std::size_t>(written));
    }
    return true;
}

Result<void> writeWhole(const std::filesystem::path& file, std::string_view content,
                        Readers readers) {
    METIER_TRY(makeFolder(file.parent_path()));
    auto pattern = file.string() + ".XXXXXX";
    const Descriptor descriptor(::mkstemp(pattern.data()));  // accessible to its owner only
    if (!descriptor) {
        return failed(file);
    }
    const auto mode = readers == Readers::owner ? kOwnerOnly : kEverybody;
    const bool written = ::fchmod(descriptor.get(), mode) == 0 && writeAll(descriptor, content) &&
                         ::fsync(descriptor.get()) == 0 &&
                         ::rename(pattern.c_str(), file.c_str()) == 0;
    if (!written) {
        const int error = errno;
        ::unlink(pattern.c_str());
        return failed(file, error);
    }
    return {};
}

Result<std::string> readPrivate(const std::filesystem::path& file) {
    METIER_TRY(checkReaders(file));
    auto text = readFile(file.string());
    std::error_code error;
    if (text.empty() && std::filesystem::file_size(file, error) != 0) {
        return fail(Errc::invalid_argument,
                    fmt::format("{} cannot be read, or is over 64 kB", file.string()));
    }
    return text;
}

}  // namespace metier::security
