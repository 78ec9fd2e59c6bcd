#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <unordered_set>

#include "metier/skill/name_file.hpp"

namespace metier::skill {

/// Names in `file` and, once that has grown, in `file`.old.
class DiskNames final : public NameFile {
public:
    /// The names of a file, and those of the file before it.
    struct Known {
        std::unordered_set<std::string> newer;
        std::unordered_set<std::string> older;
    };

    /// Makes missing folders, and takes back a line that a crash has cut off.
    /// Errors: resource_unavailable (another server has the file open, or it cannot be written).
    static Result<std::unique_ptr<DiskNames>> open(const std::filesystem::path& file, Known& known);
    ~DiskNames() override;
    DiskNames(const DiskNames&) = delete;
    DiskNames& operator=(const DiskNames&) = delete;

    Result<void> append(const std::string& line) override;
    Result<void> beginAnew() override;

private:
    explicit DiskNames(std::filesystem::path file) : file_(std::move(file)) {}
    Result<void> openFile();
    void closeFile();

    std::filesystem::path file_;
    int descriptor_ = -1;
    std::uintmax_t size_ = 0;  ///< size of the file [byte]
};

}  // namespace metier::skill
