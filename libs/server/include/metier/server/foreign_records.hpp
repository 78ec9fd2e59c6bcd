#pragma once

#include <functional>
#include <memory>
#include <mutex>
#include <set>
#include <string>
#include <utility>

#include "metier/composition/used_skill.hpp"
#include "metier/records/recorder.hpp"
#include "metier/skill/program.hpp"
#include "metier/skill/state.hpp"

namespace metier::server {

/// Names under which the executions of a foreign skill are recorded.
struct ForeignPlace {
    /// Name of its server, or its address.
    std::string server;
    /// BrowseName of the object to which it belongs; may be empty.
    std::string controller;
    /// BrowseName of its Program.
    std::string skill;
};

/// Opens a store for what a client program starts at foreign servers. Nothing is removed from it:
/// how long records are kept is up to the servers that use it.
/// \param records a store, as records::Store::open() takes it
/// \param program name of the client in the records: "run"
/// \param on_problem called with a text for a person when the store cannot be written, and when it
///                   can be again; on the thread that writes
/// Errors: invalid_argument (not a store). Threads: any.
Result<std::unique_ptr<records::Recorder>> openForeignStore(
    const std::string& records, const std::string& program,
    std::function<void(const std::string& text)> on_problem);

/// Records of executions at servers that record none themselves, kept by the client that starts
/// them.
///
/// Threading: any; letGo() once no execution is begun any more.
class ForeignRecords {
public:
    /// Key of one execution; 0: none is recorded.
    using Key = records::Recorder::Key;

    /// \param recorder used until letGo()
    explicit ForeignRecords(records::Recorder& recorder) : recorder_(&recorder) {}
    /// Opens the store with the first execution; without it nothing is recorded.
    explicit ForeignRecords(std::function<Result<std::unique_ptr<records::Recorder>>()> open)
        : open_(std::move(open)) {}

    /// Begins a record. \return 0 if there is none; nothing of it is recorded then
    Key begin(records::ExecutionRow execution);
    /// Adds a transition, if the execution is under way.
    void add(Key key, records::Transition transition);
    /// Ends the record, if the execution is under way.
    void end(Key key, records::Outcome outcome);
    /// Ends what is under way: its end is unknown. Nothing is recorded afterwards.
    void letGo();

private:
    std::mutex mutex_;
    // Guarded by mutex_.
    std::function<Result<std::unique_ptr<records::Recorder>>()> open_;  // empty: it was called
    std::unique_ptr<records::Recorder> own_;
    records::Recorder* recorder_ = nullptr;  // null before the first execution and after letGo()
    std::set<Key> under_way_;
};

/// Record of one execution of a foreign skill, from its start on:
///
///     ForeignExecution record(records, {url, "Torch", "Weld"}, request, "no dead-man");
///     record.add(State::running, State::suspended);
///     record.end({UsedSkillEnd::Kind::finished, result});
///
/// Threading: one thread at a time.
class ForeignExecution {
public:
    /// \param records not null
    /// \param lacks what the server does not have, for the first transition: "no dead-man"
    ForeignExecution(std::shared_ptr<ForeignRecords> records, const ForeignPlace& place,
                     const skill::StartRequest& request, const std::string& lacks);
    /// Ends the record, if end() did not: nobody waited for the execution's end.
    ~ForeignExecution();
    ForeignExecution(const ForeignExecution&) = delete;
    ForeignExecution& operator=(const ForeignExecution&) = delete;

    /// Adds a transition that has just happened.
    void add(skill::State from, skill::State to) { add(from, to, {}); }
    /// Ends the record; nothing is added afterwards.
    void end(const composition::UsedSkillEnd& end);

private:
    void add(skill::State from, skill::State to, std::string text);

    std::shared_ptr<ForeignRecords> records_;  // shared by all executions
    ForeignRecords::Key key_;
};

}  // namespace metier::server
