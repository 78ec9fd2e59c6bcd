#include "private_file.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <system_error>

namespace metier::trust {
namespace {

constexpr mode_t kOwnerOnly = 0600;
constexpr mode_t kEverybody = 0644;

tl::unexpected<Error> failed(const std::filesystem::path& file, int error) {
    return fail(Errc::resource_unavailable,
                fmt::format("{}: {}", file.string(), std::generic_category().message(error)));
}

/// Closes a descriptor at its end.
class Descriptor {
public:
    explicit Descriptor(int number) noexcept : number_(number) {}
    ~Descriptor() {
        if (number_ >= 0) {
            ::close(number_);
        }
    }
    Descriptor(const Descriptor&) = delete;
    Descriptor& operator=(const Descriptor&) = delete;
    int number() const noexcept { return number_; }

private:
    int number_;
};

bool writeAll(int descriptor, std::string_view content) {
    while (!content.empty()) {
        const auto written = ::write(descriptor, content.data(), content.size());
        if (written < 0 && errno == EINTR) {
            continue;
        }
        if (written <= 0) {
            return false;
        }
        content.remove_prefix(static_cast<std::size_t>(written));
    }
    return ::fsync(descriptor) == 0;
}

Result<void> makeFolder(const std::filesystem::path& folder) {
    std::error_code error;
    const bool made = std::filesystem::create_directories(folder, error);
    if (!error && made) {
        std::filesystem::permissions(folder, std::filesystem::perms::owner_all, error);
    }
    return error ? failed(folder, error.value()) : Result<void>();
}

}  // namespace

Result<void> writeWhole(const std::filesystem::path& file, std::string_view content,
                        Readers readers) {
    if (auto made = makeFolder(file.parent_path()); !made) {
        return made;
    }
    auto pattern = file.string() + ".XXXXXX";
    const Descriptor descriptor(::mkstemp(pattern.data()));  // for its owner alone
    if (descriptor.number() < 0) {
        return failed(file, errno);
    }
    const bool written =
        ::fchmod(descriptor.number(), readers == Readers::owner ? kOwnerOnly : kEverybody) == 0 &&
        writeAll(descriptor.number(), content) && ::rename(pattern.c_str(), file.c_str()) == 0;
    if (!written) {
        const int error = errno;
        ::unlink(pattern.c_str());
        return failed(file, error);
    }
    return {};
}

}  // namespace metier::trust
