#pragma once

#include <sched.h>
#include <sys/mount.h>

#include <filesystem>
#include <fstream>
#include <memory>
#include <string>

namespace metier::system_tests {

constexpr const char* kNoSmallDisk =
    "A FULL DISK WAS NOT TESTED: to mount one needs root, and no changed root folder";

/// A small disk, which this thread and the processes that it starts see.
class SmallDisk {
public:
    /// Nothing where none can be mounted: that needs root, and a `/` that is a mount point, as in
    /// every system but one in a changed root.
    /// \param kilobytes its size [1024 byte]
    static std::unique_ptr<SmallDisk> mount(const std::filesystem::path& folder,
                                            int kilobytes = 64) {
        const auto size = "size=" + std::to_string(kilobytes) + "k";
        const bool mounted = ::unshare(CLONE_NEWNS) == 0 &&
                             ::mount("none", "/", nullptr, MS_REC | MS_PRIVATE, nullptr) == 0 &&
                             ::mount("tmpfs", folder.c_str(), "tmpfs", 0, size.c_str()) == 0;
        return mounted ? std::make_unique<SmallDisk>(folder) : nullptr;
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
