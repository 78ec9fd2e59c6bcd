#pragma once

#include <chrono>
#include <cstddef>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <unordered_set>

#include "metier/base/error.hpp"
#include "metier/skill/name_file.hpp"

namespace metier::skill {

class NameWriter;

/// The names that clients have given to executions, so that none of them ever starts twice: not
/// after its record is forgotten, nor, with a file, after the server was started again.
///
/// Shared by the Programs of a server.
/// Threading: the owner's thread, which never waits for the disk: a thread of its own writes a line
/// per name. The system keeps the line should this process be killed; only a machine that loses its
/// power may lose the last ones. The end waits for the write that is under way.
class ExecutionNames {
public:
    /// As many of the latest names are always known; older ones are forgotten, sooner or later.
    static constexpr std::size_t kLeast = 100'000;

    struct Options {
        std::size_t least = kLeast;
        /// While the disk takes longer for a name, no more are taken.
        std::chrono::milliseconds longest_write{250};
    };
    enum class Keeping {
        kept,
        under_way,  ///< on its way to the file
    };
    /// Called once, on another thread: the name is in the file, or why not.
    using OnKept = std::function<void(Result<void>)>;

    /// Names that are kept as long as this lives.
    explicit ExecutionNames(std::size_t least = kLeast);
    /// Names that are kept in `file`; `options.least` of the latest are known.
    ExecutionNames(std::unique_ptr<NameFile> file, const Options& options);
    /// Names that are kept in `file` (and, once that has grown, in `file`.old), which one server
    /// has to itself. Missing folders are made.
    /// Errors: resource_unavailable (another server has the file open, or it cannot be written).
    static Result<std::unique_ptr<ExecutionNames>> open(const std::filesystem::path& file,
                                                        std::size_t least = kLeast);
    ~ExecutionNames();
    ExecutionNames(const ExecutionNames&) = delete;
    ExecutionNames& operator=(const ExecutionNames&) = delete;

    bool knows(std::string_view skill, std::string_view name) const;
    /// To be called before the execution begins: it must not before the name is kept. The name is
    /// known from here on.
    /// \param on_kept called only after `under_way`
    /// Errors: resource_unavailable (the disk hangs); the name is not known then.
    Result<Keeping> note(std::string_view skill, std::string_view name, OnKept on_kept);
    /// A name that is not kept after all may be used again.
    void forget(std::string_view skill, std::string_view name);

private:
    std::size_t least_;
    // An entry is a line of the file. The older set goes when the newer one is full.
    std::unordered_set<std::string> newer_;
    std::unordered_set<std::string> older_;
    std::unique_ptr<NameWriter> writer_;  ///< null: in memory only
};

/// What a client is told of a name that is known while its execution is not any more.
std::string forgottenText(std::string_view name);

}  // namespace metier::skill
