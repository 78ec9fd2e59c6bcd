#pragma once

#include <memory>
#include <set>
#include <string>

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

/// Records of executions at servers that record none themselves, kept by the client that starts
/// them.
///
/// Threading: one thread at a time; letGo() once no execution is begun any more.
class ForeignRecords {
public:
    /// Key of one execution; 0: none is recorded.
    using Key = records::Recorder::Key;

    /// \param recorder used until letGo()
    explicit ForeignRecords(records::Recorder& recorder) : recorder_(&recorder) {}

    /// Begins a record. \return 0 if there is none; nothing of it is recorded then
    Key begin(records::ExecutionRow execution);
    /// Adds a transition, if the execution is under way.
    void add(Key key, records::Transition transition);
    /// Ends the record, if the execution is under way.
    void end(Key key, records::Outcome outcome);
    /// Ends what is under way: its end is unknown. Nothing is recorded afterwards.
    void letGo();

private:
    records::Recorder* recorder_;  // null after letGo()
    std::set<Key> under_way_;
};

/// Record of one execution of a foreign skill, from its start on:
///
///     ForeignExecution record(records, {url, "Torch", "Weld"}, request, "no dead-man");
///     record.add(State::running, State::suspended);
///     record.end({UsedSkillEnd::Kind::finished, result});
///
/// Threading: as ForeignRecords.
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
