#pragma once

#include <memory>
#include <set>
#include <string>

#include "metier/composition/used_skill.hpp"
#include "metier/records/recorder.hpp"

namespace metier::server {

/// Names under which the executions of a used skill are recorded.
struct ForeignPlace {
    std::string server;      ///< name of its server
    std::string controller;  ///< BrowseName of the object to which it belongs; may be empty
    std::string skill;       ///< BrowseName of its Program
};

/// Records of executions at servers that record none themselves, among those of the server that
/// starts them. Shared by its used skills.
///
/// Threading: the server's thread; letGo() once that has ended.
class ForeignRecords {
public:
    using Key = records::Recorder::Key;

    /// \param recorder used until letGo()
    explicit ForeignRecords(records::Recorder& recorder) : recorder_(&recorder) {}

    /// Begins a record. \return 0 if there is none; nothing of it is recorded then
    Key begin(records::ExecutionRow execution);
    void add(Key key, records::Transition transition);
    void end(Key key, records::Outcome outcome);
    /// Ends what is under way: its end is unknown. Nothing is recorded afterwards.
    void letGo();

private:
    records::Recorder* recorder_;  // null after letGo()
    std::set<Key> under_way_;
};

/// A used skill whose executions are recorded while UsedSkill::lacks() names something: then its
/// server is not one of metier's. All calls go to `used`.
std::unique_ptr<composition::UsedSkill> recorded(std::unique_ptr<composition::UsedSkill> used,
                                                 std::shared_ptr<ForeignRecords> records,
                                                 ForeignPlace place);

}  // namespace metier::server
