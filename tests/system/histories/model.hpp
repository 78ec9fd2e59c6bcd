#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "metier/skill/state.hpp"
#include "step.hpp"

namespace metier::system_tests {

/// Taker of steps that can be asked what clients see: the server, or the model of it.
class Taker {
public:
    virtual ~Taker() = default;
    /// \return the reply to the client
    virtual std::string take(const Step& step) = 0;
    /// View of the clients now, one text per line; it includes the events since the last call.
    virtual std::vector<std::string> seen() = 0;
};

/// [ms]; no two of them, nor their sums, fall due at the same time, since steps last 10 ms each.
struct Times {
    static constexpr std::int64_t kLease = 3'001;
    static constexpr std::int64_t kRestDeadline = 5'002;
    static constexpr std::int64_t kConfiguration = 10'004;
    static constexpr std::int64_t kLock = 60'000;
};

/// The line in which a skill shows itself.
struct SkillLine {
    std::string state;
    std::string sub_state;
    std::string target;
    std::string speed;
    std::string result;

    std::string toString(std::size_t skill) const;
};

/// docs/model.md, sections 2 to 4, for two skills of one controller: the first may be suspended and
/// halts if its owner is lost, the second can do neither. Knows nothing of the code under test but
/// the names of its enumerations.
class Model : public Taker {
public:
    /// \param results of executions before
    explicit Model(const std::array<std::string, kSkills>& results);

    std::string take(const Step& step) override;
    std::vector<std::string> seen() override;

protected:
    skill::State stateOf(std::size_t skill) const { return skills_.at(skill).state; }

private:
    using Session = std::size_t;
    struct Record {
        skill::State state;
        skill::Reason reason;
    };
    struct SkillModel {
        skill::State state = skill::State::ready;
        skill::SubState sub_state = skill::SubState::ready_not_configured;
        std::optional<double> target{};
        double speed = 0.5;
        std::string result{};
        std::optional<Session> bound{};
        std::int64_t bound_until = 0;
        std::uint32_t name = 0;  ///< of the execution; 0: made by the server
        double started_speed = 0;
        std::optional<Session> owner{};
        skill::OwnerLossAction on_owner_loss = skill::OwnerLossAction::skill_default;
        std::optional<skill::Reason> halting{};
        skill::Reason suspending = skill::Reason::by_client;
        std::optional<std::int64_t> rest_until{};
        bool done = false;
        bool fault_stays = false;
        std::map<std::uint32_t, Record> records{};
        std::vector<std::string> events{};

        bool hasWork() const {
            return state == skill::State::running || state == skill::State::suspended;
        }
        bool isFirst = true;
    };

    std::string write(SkillModel& skill, Session session, const Step& step);
    std::string refusalOfWrite(const SkillModel& skill, Session session) const;
    std::string refusalOfStart(const SkillModel& skill, Session session) const;
    std::string start(SkillModel& skill, Session session);
    std::string startWith(SkillModel& skill, std::size_t client, std::uint32_t value);
    std::string check(const SkillModel& skill, Session session, std::uint32_t value) const;
    static std::string refusalOfValues(const StartChoice& choice);
    std::string command(SkillModel& skill, const Step& step);
    std::string suspend(SkillModel& skill, Session session);
    std::string resume(SkillModel& skill, Session session);
    static std::string halt(SkillModel& skill, std::int64_t now);
    std::string reset(SkillModel& skill, Session session);
    static std::string execution(const SkillModel& skill, std::uint32_t name);

    std::string control(const Step& step);
    std::string acquire(std::size_t client, std::uint32_t action);
    bool holdsLease(std::size_t client) const;
    std::string lock(const Step& step);

    void happen(SkillModel& skill, const Step& step);
    static void atRest(SkillModel& skill);
    static void finish(SkillModel& skill);
    void closeSession(std::size_t client);
    void loseLease();
    void loseOwner(SkillModel& skill, skill::OwnerLossAction of_lease) const;
    void wait(std::int64_t time);
    std::optional<std::int64_t> nextDue() const;
    void fallDue();

    static void begin(SkillModel& skill, Session session, std::uint32_t name, double speed);
    static void go(SkillModel& skill, skill::State to, skill::Reason reason);
    static void brake(SkillModel& skill, skill::Reason reason, std::int64_t now);
    static void stop(SkillModel& skill, std::int64_t now);
    static void endConfiguration(SkillModel& skill);
    bool mayCommand(Session session) const;
    bool isFree(Session session) const;
    bool isBusy() const;

    std::int64_t now_ = 0;
    std::array<SkillModel, kSkills> skills_;
    std::array<Session, kClients> sessions_{0, 1, 2};
    std::array<std::uint64_t, kClients> epochs_{};  ///< last one of each client, 0: none
    std::optional<Session> leased_;
    std::uint64_t lease_ = 0;
    std::uint64_t leases_ = 0;
    std::int64_t leased_until_ = 0;
    skill::OwnerLossAction lease_action_ = skill::OwnerLossAction::skill_default;
    std::set<Session> stale_;  ///< sessions whose lease ran out
    std::optional<Session> locked_;
    std::int64_t locked_until_ = 0;
};

/// Line for an event.
std::string eventLine(skill::State from, skill::State to, skill::Reason reason,
                      const std::string& execution);
/// Text of a number.
std::string numberText(double number);

}  // namespace metier::system_tests
