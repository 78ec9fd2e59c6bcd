#include "robot_options.hpp"

#include <gmock/gmock.h>

#include <fstream>
#include <sstream>

namespace metier::virtual_ur {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using Values = std::map<std::string, cell::Settings::Value>;

/// The UR5 under another name.
motion::RobotModel modelCalled(const std::string& name) {
    std::stringstream text;
    text << std::ifstream(METIER_MODELS_DIR "/ur5.toml").rdbuf();
    auto toml = text.str();
    toml.replace(toml.find("name = \"ur5\""), 12, "name = \"" + name + "\"");
    return motion::RobotModel::parse(toml, name).value();
}

RobotOptions optionsOf(const std::string& name, Values values = {}) {
    const auto model = modelCalled(name);
    return readOptions(cell::Settings("test", std::move(values)), model).value();
}

std::string refusalOf(Values values) {
    const auto model = modelCalled("ur5");
    const auto options = readOptions(cell::Settings("test", std::move(values)), model);
    return options ? "none" : options.error().message;
}

TEST(RobotOptions, HaveTheTypeOfTheArmThatTheModelIsNamedAfter) {
    const std::map<std::string, int> types{
        {"ur5", 1},           {"ur5e", 1},           {"ur10", 2},    {"ur10e", 2},
        {"ur3", 3},           {"UR3e", 3},           {"ur16e", 4},   {"ur18", 5},
        {"ur20", 7},          {"ur30", 8},           {"ur8long", 6}, {"ur15", 9},
        {"cell3_ur10e", 2},   {"ur5_of_line_10", 1}, {"our_arm", 1}, {"ur", 1},
        {"ur99999999999", 1}, {"ur10_curve", 2}};
    for (const auto& [name, type] : types) {
        EXPECT_EQ(optionsOf(name).description.robot_type, type) << name;
    }
}

TEST(RobotOptions, HaveTheSeriesThatMakesTheArm) {
    for (const auto* name : {"ur3", "ur5", "ur10", "arm"}) {
        EXPECT_EQ(optionsOf(name).description.series, Series::cb3) << name;
    }
    for (const auto* name : {"ur3e", "ur16e", "ur20", "ur30"}) {
        const auto options = optionsOf(name);
        EXPECT_EQ(options.description.series, Series::e_series) << name;
        EXPECT_EQ(options.description.version.major, 5U) << name;
        EXPECT_EQ(options.arm.cycle, 0.002) << name;
    }
    EXPECT_EQ(optionsOf("ur20", {{"series", std::string("cb3")}}).arm.cycle, 0.008);
}

TEST(RobotOptions, NameTheArmAsItsDashboardDoes) {
    EXPECT_EQ(optionsOf("ur16e").robot_model, "UR16");
    EXPECT_EQ(optionsOf("ur30").robot_model, "UR30");
    EXPECT_EQ(optionsOf("ur5", {{"robot_model", std::string("UR5")}}).robot_model, "UR5");
}

TEST(RobotOptions, MayStartAtALimitButNotBeyondIt) {
    const auto model = modelCalled("ur5");
    auto start = std::vector<double>(model.home().begin(), model.home().end());
    start[2] = model.limits(2).upper;
    EXPECT_EQ(optionsOf("ur5", {{"start", start}}).arm.start[2], start[2]);
    start[2] += 1e-9;
    EXPECT_THAT(refusalOf({{"start", start}}), HasSubstr("axis 3: "));
    start.pop_back();
    EXPECT_THAT(refusalOf({{"start", start}}), HasSubstr("start"));
}

TEST(RobotOptions, RefuseNumbersBeyondTheirLimits) {
    for (const auto* name : {"power_on_time", "brake_release_time", "unlock_delay"}) {
        EXPECT_EQ(refusalOf({{name, 60.0}}), "none") << name;
        EXPECT_THAT(refusalOf({{name, 60.1}}), HasSubstr(name));
        EXPECT_THAT(refusalOf({{name, -0.1}}), HasSubstr(name));
    }
    for (const auto* name : {"joint_acceleration", "stop_deceleration"}) {
        EXPECT_EQ(refusalOf({{name, 0.1}}), "none") << name;
        EXPECT_THAT(refusalOf({{name, 0.0}}), HasSubstr(name));
    }
    EXPECT_THAT(
        refusalOf({{"rtde_port", 65'536.0}, {"primary_port", -1.0}, {"port", 1.0}}),
        AllOf(HasSubstr("rtde_port"), HasSubstr("primary_port"), HasSubstr("port: unknown")));
}

TEST(RobotOptions, GiveEachServiceThePortThatIsSet) {
    const auto ports = optionsOf("ur5", {{"rtde_port", 0.0}, {"dashboard_port", 29'000.0}}).ports;
    for (std::size_t i = 0; i < kServices.size(); ++i) {
        const auto& service = kServices[i];
        const int expected = service.name == "rtde"        ? 0
                             : service.name == "dashboard" ? 29'000
                                                           : service.usual_port;
        EXPECT_EQ(ports[i], expected) << service.name;
    }
}

}  // namespace
}  // namespace metier::virtual_ur
