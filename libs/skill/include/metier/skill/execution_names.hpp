#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>
#include <unordered_set>

#include "metier/base/error.hpp"

namespace metier::skill {

/// The names that clients have given to executions, so that none of them ever starts twice: not
/// after its record is forgotten, nor, with a file, after the server was started again.
///
/// Shared by the Programs of a server.
/// Threading: the owner's thread. note() writes a line to the file, which the system keeps should
/// this process be killed; only a machine that loses its power may lose the last ones.
class ExecutionNames {
public:
    /// As many of the latest names are always known; older ones are forgotten, sooner or later.
    static constexpr std::size_t kLeast = 100'000;

    /// Names that are kept as long as this lives.
    /// \param least for the tests
    explicit ExecutionNames(std::size_t least = kLeast) : least_(least) {}
    /// Names that are kept in `file` (and, once that has grown, in `file`.old), which one server
    /// has to itself. Missing folders are made.
    /// Errors: resource_unavailable (another server has the file open, or it cannot be written).
    static Result<std::unique_ptr<ExecutionNames>> open(const std::filesystem::path& file,
                                                        std::size_t least = kLeast);
    ~ExecutionNames();
    ExecutionNames(const ExecutionNames&) = delete;
    ExecutionNames& operator=(const ExecutionNames&) = delete;

    bool knows(std::string_view skill, std::string_view name) const;
    /// To be called before the execution begins: it must not, if this fails.
    /// Errors: resource_unavailable (the file cannot be written).
    Result<void> note(std::string_view skill, std::string_view name);

private:
    Result<void> openFile();
    void closeFile();
    Result<void> append(const std::string& line);
    Result<void> beginAnew();

    std::size_t least_;
    std::filesystem::path file_;  ///< empty: in memory only
    int descriptor_ = -1;
    std::uintmax_t size_ = 0;  ///< of the file [byte]
    // An entry is a line of the file. The older set goes when the newer one is full.
    std::unordered_set<std::string> newer_;
    std::unordered_set<std::string> older_;
};

/// What a client is told of a name that is known while its execution is not any more.
std::string forgottenText(std::string_view name);

}  // namespace metier::skill
