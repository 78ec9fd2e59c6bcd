#pragma once

#include <sched.h>
#include <sys/mount.h>

#include <cerrno>
#include <filesystem>
#include <fstream>
#include <memory>
#include <string>
#include <system_error>

namespace metier::system_tests {

constexpr const char* kNoSmallDisk =
    "A FULL DISK WAS NOT TESTED: to mount one needs root, and no changed root folder";

/// A small disk, which this thread and the processes that it starts see.
class SmallDisk {
public:
    /// Nothing where none can be mounted: that needs root, and a `/` that is a mount point, as in
    /// every system but one in a changed root. Throws if it fails for another reason.
    /// \param kilobytes its size [1024 byte]
    static std::unique_ptr<SmallDisk> mount(const std::filesystem::path& folder,
                                            int kilobytes = 64) {
        if (::unshare(CLONE_NEWNS) != 0 ||
            ::mount("none", "/", nullptr, MS_REC | MS_PRIVATE, nullptr) != 0) {
            if (errno == EPERM || errno == EINVAL) {
                return nullptr;
            }
            throw std::system_error(errno, std::generic_category(), "own mounts");
        }
        const auto size = "size=" + std::to_string(kilobytes) + "k";
        if (::mount("tmpfs", folder.c_str(), "tmpfs", 0, size.c_str()) != 0) {
            throw std::system_error(errno, std::generic_category(), "a tmpfs");
        }
        return std::make_unique<SmallDisk>(folder);
    }
    /// \param folder where it is mounted
    explicit SmallDisk(const std::filesystem::path& folder) : filler_(folder / "filler") {}

    void fill() const {
        std::ofstream file(filler_, std::ios::binary);
        while (file << std::string(512, 'x') << std::flush) {
        }
    }
    void makeRoom() const { std::filesystem::remove(filler_); }

private:
    std::filesystem::path filler_;
};

}  // namespace metier::system_tests
