#include <utility>

#include "synchronized/synchronized_work.hpp"

namespace metier::composition {

using skill::Field;

namespace {

constexpr double kLongestDuration = 3600.0;  // [s]

Field seconds(std::string name, std::string description) {
    return {.name = std::move(name), .description = std::move(description), .unit = skill::kSecond};
}

}  // namespace

skill::FieldList<Parameters> parameterFields(std::vector<std::string> arms) {
    skill::FieldList<Parameters> fields;
    const skill::LengthLimit at_least_two{2, arms.size()};
    fields.add(&Parameters::arms,
               Field{.name = "Arms",
                     .description = "Names of the arms, as the cell file has them",
                     .length = at_least_two,
                     .default_value = std::move(arms)});
    fields.add(&Parameters::target_poses,
               Field{.name = "TargetPoses",
                     .description = "One pose per arm, of its tool frame in its base frame",
                     .length = at_least_two});
    fields.add(&Parameters::tool_frames,
               Field{.name = "ToolFrames",
                     .description = "Name of each arm's tool frame; none: the flanges",
                     .default_value = std::vector<std::string>()});
    auto duration =
        seconds("Duration", "Least time that the motion takes; 0: as the slowest needs");
    duration.range = skill::Range{0.0, kLongestDuration};
    duration.default_value = 0.0;
    fields.add(&Parameters::duration, std::move(duration));
    return fields;
}

const skill::FieldList<Results>& resultFields() {
    static const auto fields = [] {
        skill::FieldList<Results> list;
        list.add(&Results::skew_at_start,
                 seconds("SkewAtStart",
                         "Time between the first set-points of the first and of the last arm"));
        list.add(&Results::largest_skew,
                 seconds("LargestSkew", "No two arms were further apart in time on the way"));
        list.add(&Results::skew_at_end,
                 seconds("SkewAtEnd",
                         "Time between the last set-points of the first and of the last arm"));
        list.add(&Results::clock_uncertainty,
                 seconds("ClockUncertainty", "How far the skews may be wrong"));
        list.add(
            &Results::duration,
            seconds("Duration", "From the first arm's first set-point to the last one's last"));
        return list;
    }();
    return fields;
}

}  // namespace metier::composition
