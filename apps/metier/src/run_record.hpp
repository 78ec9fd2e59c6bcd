#pragma once

#include <memory>
#include <mutex>
#include <string>

#include "metier/records/recorder.hpp"
#include "metier/server/foreign_records.hpp"
#include "metier/skill/program_observer.hpp"
#include "servers.hpp"

namespace metier::app {

/// Record of one run of a skill whose server records none, since it is of another maker.
///
/// Threading: any; the end of this object waits for the store.
class RunRecord {
public:
    /// Begins the record. A store that cannot be written is reported on standard error, and the run
    /// goes on.
    /// \param records store, as Store::open() takes it; "off" or empty: none
    /// \return null if nothing is to be recorded here
    /// Errors: invalid_argument (not a store).
    static Result<std::shared_ptr<RunRecord>> begin(const std::string& records,
                                                    const OpenSkill& skill,
                                                    const skill::StartRequest& request);

    /// Adds a transition of the skill, if it is one of Suspend or Resume.
    void add(const skill::TransitionEvent& event);

    /// Facts about a run that is over, besides its outcome.
    struct Over {
        skill::State state;  ///< of the skill now
        bool halted_here;    ///< whether this command wanted a Halt
    };
    /// Ends the record; nothing is added afterwards. Waits up to 5 s for the store. If it has not
    /// taken the record until then, this is reported on standard error, and the program is ended
    /// within 10 s.
    void end(const opcua::Answer<skill::ValueMap>& outcome, const Over& over);

private:
    RunRecord(std::unique_ptr<records::Recorder> recorder, const server::ForeignPlace& place,
              const skill::StartRequest& request, const std::string& lacks);

    std::mutex mutex_;
    std::unique_ptr<records::Recorder> recorder_;
    server::ForeignExecution execution_;  // guarded by mutex_
};

}  // namespace metier::app
