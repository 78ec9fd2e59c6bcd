#pragma once

#include <unistd.h>

#include <filesystem>
#include <string>
#include <system_error>

namespace metier::fuzz {

/// A path of this process alone, which is removed at the end; in memory where the system has such
/// files: a disk that is written through takes a hundred times as long.
class Scratch {
public:
    explicit Scratch(const std::string& name)
        : path_(folder() / (name + "_" + std::to_string(::getpid()))) {
        remove();
    }
    ~Scratch() { remove(); }
    Scratch(const Scratch&) = delete;
    Scratch& operator=(const Scratch&) = delete;
    const std::filesystem::path& path() const { return path_; }

private:
    static std::filesystem::path folder() {
        const std::filesystem::path memory("/dev/shm");
        return std::filesystem::is_directory(memory) ? memory
                                                     : std::filesystem::temp_directory_path();
    }
    void remove() const {
        std::error_code error;
        std::filesystem::remove_all(path_, error);
    }

    const std::filesystem::path path_;
};

}  // namespace metier::fuzz
