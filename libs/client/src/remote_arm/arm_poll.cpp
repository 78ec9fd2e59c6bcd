#include "remote_arm/arm_poll.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <utility>

#include "metier/base/clock.hpp"

namespace metier::client {
namespace {

using namespace std::chrono_literals;
using device::SafetyState;
using opcua::DataValue;

// A server that does not answer for this long counts as lost.
constexpr auto kLongestAnswer = 2s;

/// A number, also of a server whose axes are Float.
std::optional<double> numberOf(const opcua::Value& value) {
    if (const auto number = value.as<double>()) {
        return *number;
    }
    const auto number = value.as<float>();
    return number ? std::optional<double>(*number) : std::nullopt;
}

}  // namespace

/// Meaning of the values of one answer: axes as the server lists them, emergency stops, protective
/// stops, and the state of the skill.
struct ArmPoll::Layout {
    std::vector<RoboticsAxis> axes;
    std::vector<JointPlace> places;
    std::size_t emergency_stops = 0;
    std::size_t protective_stops = 0;
    bool program = false;
    /// Which stops have had a value; used by one thread at a time.
    std::vector<bool> known_stops = std::vector<bool>(emergency_stops + protective_stops);

    /// Measured joint positions [rad]; nothing if one of them is not there now.
    std::optional<device::JointArray> positionIn(const std::vector<DataValue>& values) const {
        device::JointArray position(places.size());
        for (std::size_t joint = 0; joint < places.size(); ++joint) {
            const auto axis = places[joint].axis;
            const auto number = numberOf(values[axis].value);
            if (!number || values[axis].status.isBad()) {
                return std::nullopt;
            }
            position[joint] = *number * axes[axis].radians_per_unit;
        }
        return position;
    }

    /// The first stop that is pressed; disconnected if one has no value any more.
    SafetyState stopIn(const std::vector<DataValue>& values) {
        auto state = SafetyState::normal;
        for (std::size_t stop = 0; stop < known_stops.size(); ++stop) {
            const auto& value = values[axes.size() + stop];
            const auto pressed = value.status.isBad() ? Result<bool>(fail(Errc::device_fault, ""))
                                                      : value.value.as<bool>();
            if (pressed.value_or(false)) {
                return stop < emergency_stops ? SafetyState::emergency_stop
                                              : SafetyState::protective_stop;
            }
            if (!pressed && known_stops[stop]) {
                state = SafetyState::disconnected;
            }
            known_stops[stop] = known_stops[stop] || pressed;
        }
        return state;
    }

    std::optional<skill::State> skillIn(const std::vector<DataValue>& values) const {
        if (!program) {
            return std::nullopt;
        }
        const auto first = axes.size() + emergency_stops + protective_stops;
        const std::vector<DataValue> of_program(values.begin() + static_cast<std::ptrdiff_t>(first),
                                                values.end());
        const auto now = programNow(of_program);
        return now ? std::optional(now->state) : std::nullopt;
    }

    void noteArm(const std::vector<DataValue>& values, Notes& notes) {
        if (axes.empty()) {
            return;
        }
        const auto position = positionIn(values);
        if (position) {
            notes.notePosition(*position);
        }
        notes.noteSafety(position ? stopIn(values) : SafetyState::disconnected);
    }
};

/// State of the one question that may be under way.
struct ArmPoll::Pending {
    std::atomic<bool> under_way{false};
    SteadyTime asked{};  ///< used by the owner only
};

ArmPoll::ArmPoll(opcua::Client& client, const PublishedArm& arm,
                 std::optional<ProgramNodes> program, std::shared_ptr<Notes> notes)
    : client_(client), pending_(std::make_shared<Pending>()), notes_(std::move(notes)) {
    const auto& robotics = arm.robotics;
    for (const auto& axis : robotics.axes) {
        items_.push_back({axis.position});
    }
    for (const auto* stops : {&robotics.emergency_stops, &robotics.protective_stops}) {
        for (const auto& stop : *stops) {
            items_.push_back({stop});
        }
    }
    if (program) {
        const auto of_program = programItems(*program);
        items_.insert(items_.end(), of_program.begin(), of_program.end());
    }
    layout_ =
        std::make_shared<Layout>(Layout{robotics.axes, arm.places, robotics.emergency_stops.size(),
                                        robotics.protective_stops.size(), program.has_value()});
}

void ArmPoll::ask(std::chrono::nanoseconds period) {
    const auto now = std::chrono::steady_clock::now();
    if (items_.empty() || now < pending_->asked + period || pending_->under_way.exchange(true)) {
        return;
    }
    pending_->asked = now;
    const auto asked = client_.readManyAsync(
        items_,
        [layout = layout_, pending = pending_, notes = notes_,
         commands = notes_->commands()](const opcua::Answer<std::vector<DataValue>>& answer) {
            pending->under_way = false;
            if (!answer) {
                notes->noteBroken(answer.error().message);
                return;
            }
            layout->noteArm(*answer, *notes);
            if (const auto state = layout->skillIn(*answer)) {
                notes->noteSkill(*state, commands);
            }
        },
        kLongestAnswer);
    if (!asked) {
        notes_->noteBroken(asked.error().message);
    }
}

bool ArmPoll::hasUnknownStops() const {
    const auto& known = layout_->known_stops;
    return std::find(known.begin(), known.end(), false) != known.end();
}

Result<void> ArmPoll::askAndWait() {
    if (items_.empty()) {
        return {};
    }
    METIER_ASSIGN(const auto values, client_.readMany(items_));
    layout_->noteArm(values, *notes_);
    if (!layout_->axes.empty() && !layout_->positionIn(values)) {
        return fail(Errc::type_mismatch, "the positions of the axes are not there, or no numbers");
    }
    if (const auto state = layout_->skillIn(values)) {
        notes_->noteCommanded(*state);
    }
    return {};
}

}  // namespace metier::client
