#pragma once

#include <sched.h>
#include <sys/mount.h>

#include <cerrno>
#include <filesystem>
#include <fstream>
#include <string>
#include <system_error>

namespace metier::system_tests {

/// A small disk, which this thread and the processes that it starts see.
class SmallDisk {
public:
    /// \param kilobytes its size [1024 byte]
    explicit SmallDisk(const std::filesystem::path& folder, int kilobytes = 64)
        : filler_(folder / "filler") {
        const auto size = "size=" + std::to_string(kilobytes) + "k";
        const bool mounted = ::unshare(CLONE_NEWNS) == 0 &&
                             ::mount("none", "/", nullptr, MS_REC | MS_PRIVATE, nullptr) == 0 &&
                             ::mount("tmpfs", folder.c_str(), "tmpfs", 0, size.c_str()) == 0;
        if (!mounted) {
            throw std::system_error(errno, std::generic_category(), "a tmpfs");
        }
    }
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
