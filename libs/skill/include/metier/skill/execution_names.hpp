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

/// The names that clients gave to executions, so that no name ever starts twice: neither after its
/// record was forgotten nor, with a file, after a restart of the server.
///
/// Shared by the Programs of a server. A name belongs to one skill: two skills may use the same
/// one.
/// Threading: the owner's thread, which never waits for the disk: a thread of its own writes a line
/// per name. A line survives a kill of this process; only a machine that loses its power may lose
/// the last lines. The destructor waits until the names in the queue are written, however long the
/// disk takes.
class ExecutionNames {
public:
    /// Number of the latest names that are always known; older ones are forgotten sooner or later.
    static constexpr std::size_t kLeast = 100'000;

    /// Settings of names that are kept in a file.
    struct Options {
        /// Number of the latest names that stay known; up to twice as many are kept.
        std::size_t least = kLeast;
        /// Longest time that the disk may take for one name; while it takes longer, new names are
        /// refused.
        std::chrono::milliseconds longest_write{250};
    };
    /// State of a new name.
    enum class Keeping {
        /// Known, and nothing more to wait for: names are in memory only.
        kept,
        /// Known, and on its way to the file; `on_kept` gets the outcome.
        under_way,
    };
    /// Called once, on the writing thread, when the name is in the file, or with the reason why it
    /// is not.
    using OnKept = std::function<void(Result<void>)>;

    /// Keeps names in memory only, as long as this object lives.
    /// \param least number of the latest names that stay known, > 0
    explicit ExecutionNames(std::size_t least = kLeast);
    /// Keeps names in `file`; the latest `options.least` of them are known. Names that are already
    /// in the file are not read: open() does that.
    ExecutionNames(std::unique_ptr<NameFile> file, const Options& options);
    /// Keeps names in `file` and, once that has grown, also in `file`.old; no other server may use
    /// them. Missing folders are created, the file with access for its owner only. Reads both
    /// files, so it waits for the disk: for the start of a server.
    /// Errors: resource_unavailable (another server has the file open, or it cannot be written).
    static Result<std::unique_ptr<ExecutionNames>> open(const std::filesystem::path& file,
                                                        std::size_t least = kLeast);
    ~ExecutionNames();
    ExecutionNames(const ExecutionNames&) = delete;
    ExecutionNames& operator=(const ExecutionNames&) = delete;

    /// Whether an execution of this skill has had this name, as far as it is remembered.
    /// \param skill BrowseName of the skill
    bool knows(std::string_view skill, std::string_view name) const;
    /// Adds a name. Call it before the execution begins, and begin the work only when the name is
    /// kept. The name is known from this call on. A name that is known already is added again
    /// without an error: ask knows() before.
    /// \param on_kept called only if the result is `under_way`
    /// Errors: resource_unavailable (the disk has taken longer than Options::longest_write for the
    ///         name that it writes now); then the name is not known.
    Result<Keeping> note(std::string_view skill, std::string_view name, OnKept on_kept);
    /// Removes a name that could not be kept; it may be used again. The file is not changed.
    void forget(std::string_view skill, std::string_view name);

private:
    std::size_t least_;
    // An entry is a line of the file. The older set goes when the newer one is full.
    std::unordered_set<std::string> newer_;
    std::unordered_set<std::string> older_;
    std::unique_ptr<NameWriter> writer_;  ///< null: in memory only
};

/// Text of the refusal of a start whose name is known although its execution is forgotten.
std::string forgottenText(std::string_view name);

}  // namespace metier::skill
