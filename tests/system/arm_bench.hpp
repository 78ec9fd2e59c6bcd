#pragma once

#include <chrono>
#include <memory>
#include <ostream>
#include <string>
#include <vector>

#include "metier/base/queue.hpp"
#include "metier/skill/program_observer.hpp"
#include "metier_program.hpp"
#include "running_cell.hpp"

namespace metier::system_tests {

// The cell files allow a silence of 1 s; the rest is for a computer that runs other tests.
inline constexpr std::chrono::seconds kNoticed{5};

/// One robot of tests/system/devices.
struct ArmCase {
    const char* name;             ///< name of its file
    double axis_1;                ///< target of a long move [rad]
    const char* stop_fault = "";  ///< fault for which its controller stops the arm
    /// Reaction of the arm when the cable is cut. An iiwa's cabinet does not notice, and ends the
    /// motion that it has accepted (docs/protocols/iiwa.md).
    enum class Cut { stands, goes_on } cut = Cut::stands;
    /// SpeedOverride of a long move, so that it takes some seconds.
    double speed = 0.2;
};

/// Every arm for which there is a driver; an e.DO with each generation of its software.
const std::vector<ArmCase>& allArms();

/// Activity of a skill when something happens to its device. Suspending and resuming: on the way to
/// the state of that name, or just there.
enum class When { ready, moving, suspending, suspended, resuming, halted };

std::string toString(When when);
void PrintTo(const ArmCase& arm, std::ostream* out);

/// An arm on its maker's wire, with its virtual controller and a client that moves and watches it.
/// A failure here is a failure of the test, fatal where the test cannot go on.
class ArmBench {
public:
    explicit ArmBench(const ArmCase& arm);
    ~ArmBench();
    ArmBench(const ArmBench&) = delete;
    ArmBench& operator=(const ArmBench&) = delete;

    client::SkillHandle& skill() { return skill_; }
    opcua::Client& client() { return *client_; }
    const std::vector<double>& home() const { return home_; }
    const std::string& address() const { return cell_.virtualAddress("controller"); }
    /// State that the virtual controller shows.
    nlohmann::json state() const { return cell_.state("controller"); }

    /// Something happens to the controller or its cable. Events before it are forgotten.
    void inject(const std::string& fault, const std::string& value = "");
    /// The same for an event that another process causes just after this call.
    void happensNow();
    /// Starts a move of axis 1 that takes some seconds, and waits until the controller moves.
    void startLongMove();
    /// Waits until axis 1 is by so much farther from home than now [rad].
    void awaitProgress(double farther);
    /// Brings the skill where `when` says, with a long move where it needs one.
    void bring(When when);
    /// Position of axis 1, as the virtual controller shows it [rad].
    double position() const;
    /// The next transition to Halted or Ready, which must come in time.
    skill::TransitionEvent endWithin(std::chrono::milliseconds time);
    /// The Halted that follows inject(), within kNoticed by the product's own time stamps.
    skill::TransitionEvent haltedAfterInjection();
    /// Waits until the virtual controller shows that.
    void awaitState(const std::string& name, const std::string& value) const;
    /// Waits until the skill's reason text contains `part`.
    void awaitReasonText(const std::string& part);
    /// The arm rests, short of the target.
    void expectAtRestOnTheWay() const;
    /// No axis but the first was moved, and that one not beyond its target.
    void expectNowhereElse() const;
    void expectResetAndMove();
    /// Makes the present position the home position.
    void beginAnew() { home_ = jointPosition(*client_, skill_); }

private:
    /// Waits between two looks at the controller, which reports nothing by itself.
    void pause() const;

    ArmCase arm_;
    Queue<skill::TransitionEvent> events_{1000};
    RunningCell cell_;
    std::unique_ptr<opcua::Client> client_;
    client::SkillHandle skill_;
    std::vector<double> home_;
    UtcTime injected_{};
    mutable Queue<int> nothing_{1};
};

}  // namespace metier::system_tests
