#include "metier/opcua_skill/live_figures.hpp"

#include <utility>

#include "metier/opcua/status_code.hpp"
#include "metier/opcua_skill/values.hpp"
#include "model_ids.hpp"

namespace metier::opcua_skill {
namespace {

using opcua::DataValue;
using opcua::NodeId;
using opcua::Value;

const NodeId kAnalogUnitType{0, 17497U};

/// Adds Variables to one object, until one fails.
class FigureMaker {
public:
    FigureMaker(opcua::AddressSpace& nodes, const NodeId& parent)
        : nodes_(nodes), parent_(parent), index_(nodes.namespaceIndex(kMetierUri)) {
        if (!index_) {
            outcome_ = fail(index_.error());
        }
    }

    /// One whose value stays as it is.
    FigureMaker& constant(const char* name, const char* description, const skill::Unit& unit,
                          const Value& value) {
        auto spec = specOf(name, description, skill::ValueType::number);
        spec.value = value;
        add(spec, &unit);
        return *this;
    }
    struct Figure {
        const char* name;
        const char* description;
        const skill::Unit* unit;  ///< nullptr: of no quantity
        skill::ValueType type;
    };
    /// \param read an empty Value: nothing is known now
    FigureMaker& live(const Figure& figure, std::function<Value()> read) {
        const auto node = add(specOf(figure.name, figure.description, figure.type), figure.unit);
        if (outcome_) {
            outcome_ = nodes_.setDataSource(node, {sourceOf(std::move(read))});
        }
        return *this;
    }
    const Result<void>& outcome() const noexcept { return outcome_; }

private:
    static std::function<DataValue(const opcua::Session&)> sourceOf(std::function<Value()> read) {
        return [read = std::move(read)](const opcua::Session& /*reader*/) {
            auto value = read();
            return value.isEmpty() ? DataValue{{}, opcua::status::kBadNoCommunication}
                                   : DataValue{std::move(value)};
        };
    }
    opcua::VariableSpec specOf(const char* name, const char* description, skill::ValueType type) {
        const auto shape = shapeOf(type);
        return {.node = {.parent = parent_,
                         .browse_name = {index_.value_or(0), name},
                         .description = {"en", description}},
                .data_type = shape.data_type,
                .value_rank = shape.value_rank,
                .array_dimensions = shape.array_dimensions};
    }
    NodeId add(opcua::VariableSpec spec, const skill::Unit* unit) {
        if (!outcome_) {
            return {};
        }
        if (unit != nullptr) {
            spec.type = kAnalogUnitType;
        }
        const auto node = nodes_.addVariable(spec);
        outcome_ = node ? setUnit(*node, unit) : Result<void>(fail(node.error()));
        return node.value_or(NodeId());
    }
    Result<void> setUnit(const NodeId& variable, const skill::Unit* unit) {
        if (unit == nullptr) {
            return {};
        }
        METIER_ASSIGN(const auto node, nodes_.find(variable, {0, "EngineeringUnits"}));
        return nodes_.write(node, Value::of(toOpcua(*unit)));
    }

    opcua::AddressSpace& nodes_;
    const NodeId parent_;
    const Result<std::uint16_t> index_;
    Result<void> outcome_;
};

std::vector<double> listOf(const std::array<double, 3>& vector) {
    return {vector.begin(), vector.end()};
}
template <typename T>
const T& listOf(const T& value) {
    return value;
}

template <typename T>
Value valueOf(const std::optional<T>& value) {
    return value ? Value::of(*value) : Value();
}

/// Reads one member of a figure that `read` returns; the empty Value if it returns none.
template <typename Read, typename Figure, typename T>
std::function<Value()> memberOf(Read read, T Figure::*member) {
    return [read = std::move(read), member] {
        const std::optional<Figure> now = read();
        return now ? Value::of(listOf((*now).*member)) : Value();
    };
}

void publishStream(FigureMaker& maker, const std::function<StreamFigures()>& read) {
    using skill::ValueType;
    const auto part = [&read](auto of) { return memberOf(read, of); };
    maker.live(
        {"StreamLag",
         "How much longer than PlayOutDelay the newest set-point of the position stream waits "
         "until the arm is sent it [s].",
         &skill::kSecond, ValueType::number},
        part(&StreamFigures::lag));
    maker.live({"LargestStreamLag", "Largest StreamLag since the stream's start [s].",
                &skill::kSecond, ValueType::number},
               part(&StreamFigures::largest_lag));
    maker.live(
        {"StreamClockStep",
         "Largest step of the streaming client's clock since the stream's start; below 0: back "
         "[s].",
         &skill::kSecond, ValueType::number},
        part(&StreamFigures::clock_step));
    maker.live({"RefusedSetPoints",
                "Set-points that were refused when they were written, since the stream's start.",
                nullptr, ValueType::uint64},
               part(&StreamFigures::refused));
    maker.live({"DroppedSetPoints",
                "Set-points whose time was not after that of the one before, since the stream's "
                "start.",
                nullptr, ValueType::uint64},
               part(&StreamFigures::dropped));
}

}  // namespace

Result<void> publishArmFigures(opcua::AddressSpace& nodes, const NodeId& kinematics,
                               const ArmFigures& figures) {
    using skill::ValueType;
    FigureMaker maker(nodes, kinematics);
    if (figures.commanded_joint_position) {
        maker.live({"CommandedJointPosition",
                    "Joint positions that the controller was last commanded, axis 1 first [rad].",
                    &skill::kRadian, ValueType::numbers},
                   [read = figures.commanded_joint_position] { return valueOf(read()); });
    }
    if (figures.standstill) {
        maker.live({"Standstill", "True while the measured arm does not move.", nullptr,
                    ValueType::boolean},
                   [read = figures.standstill] { return valueOf(read()); });
    }
    if (figures.stopping) {
        maker.live({"StoppingTime",
                    "Time in which the set-points would stand if the arm were halted now [s].",
                    &skill::kSecond, ValueType::number},
                   memberOf(figures.stopping, &StoppingFigures::time));
        maker.live({"StoppingDistance", "How far the tool frame would go meanwhile [m].",
                    &skill::kMetre, ValueType::number},
                   memberOf(figures.stopping, &StoppingFigures::distance));
    }
    if (figures.cycle_jitter) {
        maker.live({"CycleJitter",
                    "How far the time between two control cycles was off the period in the last "
                    "100 ms, in the mean [s].",
                    &skill::kSecond, ValueType::number},
                   [read = figures.cycle_jitter] { return valueOf(read()); });
    }
    if (figures.flange_wrench) {
        maker.live({"FlangeForce", "Force on the flange along x, y, z of its sensor [N].",
                    &skill::kNewton, ValueType::numbers},
                   memberOf(figures.flange_wrench, &FlangeWrench::force));
        maker.live({"FlangeTorque", "Torque on the flange about x, y, z of its sensor [N m].",
                    &skill::kNewtonMetre, ValueType::numbers},
                   memberOf(figures.flange_wrench, &FlangeWrench::torque));
    }
    if (figures.stream) {
        publishStream(maker, figures.stream);
    }
    return maker.outcome();
}

Result<void> publishGripperFigures(opcua::AddressSpace& nodes, const NodeId& parent,
                                   const GripperKind& kind,
                                   std::function<std::optional<GripperFigures>()> figures) {
    using skill::ValueType;
    const auto part = [read = std::move(figures)](auto of) { return memberOf(read, of); };
    FigureMaker maker(nodes, parent);
    maker.constant("GripperStroke", "Largest distance between the jaws [m].", skill::kMetre,
                   Value::of(kind.stroke));
    maker.live(
        {"GripperWidth", "Distance between the jaws [m].", &skill::kMetre, ValueType::number},
        part(&GripperFigures::width));
    if (kind.measures_force) {
        maker.live({"GripperForce", "Force on the part between the jaws [N].", &skill::kNewton,
                    ValueType::number},
                   part(&GripperFigures::force));
    }
    maker.live({"PartHeld", "True while the gripper holds a part.", nullptr, ValueType::boolean},
               part(&GripperFigures::part_held));
    return maker.outcome();
}

}  // namespace metier::opcua_skill
