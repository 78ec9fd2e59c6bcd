// What is shown of arms, of the parameters of skills, and of values that change all the time.
#include <gmock/gmock.h>

#include <chrono>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "arm_json.hpp"
#include "live_values.hpp"
#include "metier/client/testing/arm_data.hpp"
#include "skill_shown.hpp"

namespace metier::dashboard {
namespace {

using namespace std::chrono_literals;

/// A model of the folder models/. Throws if there is none of that name.
motion::RobotModel modelNamed(const std::string& name) {
    return motion::RobotModel::load(std::filesystem::path(METIER_MODELS_DIR) / (name + ".toml"))
        .value();
}

opcua_skill::KinematicsData dataOf(const motion::RobotModel& model) {
    auto data = client::testing::dataOf(model);
    data.tool_frames = {"flange", "gripper"};
    return data;
}
using nlohmann::json;

const UtcTime kNoon{std::chrono::seconds(1'800'000'000)};

class ModelOfAnArm : public ::testing::Test {
protected:
    std::string nameOf(const opcua_skill::KinematicsData& data) const {
        const auto* model = modelOf(data, models_);
        return model == nullptr ? "none" : std::string(model->name());
    }

    const std::vector<motion::RobotModel> models_{modelNamed("ur5"), modelNamed("iiwa7"),
                                                  modelNamed("iiwa14"), modelNamed("edo")};
};

TEST_F(ModelOfAnArm, IsTheOneWithTheSameAxes) {
    for (const auto& model : models_) {
        EXPECT_EQ(nameOf(dataOf(model)), model.name());
    }
}

TEST_F(ModelOfAnArm, IsTheSameForACalibratedArm) {
    auto data = dataOf(models_[0]);
    data.joint_frames[2].x += 0.004;
    data.joint_frames[3].a += 0.015;
    EXPECT_EQ(nameOf(data), "ur5");
    data.joint_frames[2].x += 0.002;
    EXPECT_EQ(nameOf(data), "none") << "6 mm are another arm";
}

TEST_F(ModelOfAnArm, IsNotThatOfAnArmWithOtherAxes) {
    auto turned = dataOf(models_[0]);
    turned.joint_axes[4] = {-turned.joint_axes[4].x, -turned.joint_axes[4].y,
                            -turned.joint_axes[4].z};
    EXPECT_EQ(nameOf(turned), "none") << "the same axis, turning the other way";
    auto raised = dataOf(models_[0]);
    raised.base_from_first_joint.z += 0.1;
    EXPECT_EQ(nameOf(raised), "none");
    EXPECT_EQ(nameOf({}), "none");
}

TEST_F(ModelOfAnArm, GivesItShapeMakerAndToolFrames) {
    const auto& model = models_[0];
    const auto shown =
        armJson({"ur5", "ur5-server", "Arm", Frame{1, 2, 0, 0, 0, 3}}, dataOf(model), models_);
    EXPECT_EQ(shown.at("model"), "ur5");
    EXPECT_EQ(shown.at("maker"), model.maker());
    EXPECT_EQ(shown.at("product"), model.product());
    EXPECT_EQ(shown.at("base"), json::array({1, 2, 0, 0, 0, 3}));
    EXPECT_EQ(shown.at("base_known"), true);
    EXPECT_EQ(shown.at("visuals").size(), model.visual().size());
    ASSERT_EQ(shown.at("capsules").size(), model.capsules().size());
    EXPECT_EQ(shown.at("capsules").at(0).at("radius"), model.capsules().front().radius);
    ASSERT_EQ(shown.at("joints").size(), 6U);
    EXPECT_EQ(shown.at("joints").at(0).at("name"), model.chain().joints.front().name);
    EXPECT_EQ(shown.at("joints").at(0).at("origin").at(2),
              rounded(model.chain().joints.front().parent_from_joint.translation.z()));
    EXPECT_EQ(shown.at("tools").at(0).at("frame"), json::array({0, 0, 0, 0, 0, 0}));
    EXPECT_TRUE(shown.at("tools").at(1).at("frame").is_null())
        << "a tool of which its server tells the name alone";
}

skill::Field fieldOf(const std::string& name, skill::ValueType type,
                     skill::Value default_value = {}) {
    skill::Field field;
    field.name = name;
    field.type = type;
    field.default_value = std::move(default_value);
    return field;
}

TEST(ShownField, HasARoleByItsNameAndType) {
    using skill::ValueType;
    for (const auto& [name, type, role] : {std::tuple{"TargetPosition", ValueType::frame, "pose"},
                                           {"Poses", ValueType::frames, "pose"},
                                           {"StartJointPosition", ValueType::numbers, "joints"},
                                           {"TargetJointPosition", ValueType::text, ""},
                                           {"MaxVelocity", ValueType::numbers, "speed"},
                                           {"Speeds", ValueType::numbers, "speed"},
                                           {"SpeedOverride", ValueType::number, "speed"},
                                           {"MaxAcceleration", ValueType::numbers, ""}}) {
        EXPECT_EQ(fieldJson(fieldOf(name, type), {}).at("role"), role) << name;
    }
}

TEST(ShownField, HasAsManyElementsAsItsDefaultOrItsArm) {
    using skill::ValueType;
    const MovedArm arm{"ur5", 6, {}};
    const auto rank = [&](const skill::Field& field) { return fieldJson(field, arm).at("rank"); };
    EXPECT_EQ(rank(fieldOf("MaxVelocity", ValueType::numbers, std::vector<double>(3))), 3);
    EXPECT_EQ(rank(fieldOf("MaxVelocity", ValueType::numbers)), 0) << "any";
    EXPECT_EQ(rank(fieldOf("TargetJointPosition", ValueType::numbers)), 6);
    EXPECT_EQ(rank(fieldOf("TargetJointPosition", ValueType::numbers, std::vector<double>(2))), 2)
        << "the server's word goes before the arm's";
    EXPECT_EQ(rank(fieldOf("TargetPosition", ValueType::frame, skill::Frame{})), 0) << "no list";
    EXPECT_EQ(rank(fieldOf("AxisBounds", ValueType::ranges, std::vector<skill::Range>(4))), 4);
}

TEST(ShownField, IsAnOptionOrAParameterWithItsLimits) {
    auto field = fieldOf("SpeedOverride", skill::ValueType::number, 0.5);
    EXPECT_EQ(fieldJson(field, {}).at("kind"), "parameter");
    EXPECT_TRUE(fieldJson(field, {}).at("minimum").is_null());
    field.place = skill::Place::options;
    field.range = skill::Range{0.1, 1.0};
    field.description = "Slower.";
    const auto shown = fieldJson(field, {"ur5", 6, {"flange"}});
    EXPECT_EQ(shown.at("kind"), "option");
    EXPECT_EQ(shown.at("minimum"), 0.1);
    EXPECT_EQ(shown.at("maximum"), 1.0);
    EXPECT_EQ(shown.at("default"), 0.5);
    EXPECT_EQ(shown.at("description"), "Slower.");
    EXPECT_FALSE(shown.contains("choices"));
    EXPECT_FALSE(fieldJson(fieldOf("ToolFrame", skill::ValueType::text), {}).contains("choices"))
        << "of no arm";
}

TEST(Stroke, IsTheLargestWidthThatAParameterMayHave) {
    const auto skills = [](const json& maximum) {
        return json::array({{{"parameters", {{{"name", "Force"}, {"maximum", 80}}}}},
                            {{"parameters", {{{"name", "GripWidth"}, {"maximum", maximum}}}}}});
    };
    EXPECT_EQ(strokeIn(skills(0.11)), 0.11);
    EXPECT_EQ(strokeIn(skills(nullptr)), 0.0);
    EXPECT_EQ(strokeIn(json::array()), 0.0);
}

TEST(LiveValuesOfAnArm, AreKeptApartFromThoseOfOthers) {
    LiveValues live;
    live.setForce("ur5", {1, 2, 3});
    live.setTorque("iiwa", {4, 5, 6});
    live.setOfGripper("gripper", "held", true);
    const auto all = live.all(kNoon);
    EXPECT_EQ(all.at("arms").at("ur5").at("f"), json::array({1, 2, 3, 0, 0, 0}));
    EXPECT_EQ(all.at("arms").at("iiwa").at("f"), json::array({0, 0, 0, 4, 5, 6}));
    EXPECT_EQ(all.at("grippers").at("gripper").at("held"), true);
    EXPECT_EQ(all.at("t"), 1'800'000'000.0);
}

TEST(LiveValuesOfAnArm, HaveNoVelocityAcrossOtherAxesOrATimeThatStands) {
    LiveValues live;
    const auto velocity = [&] { return live.all(kNoon).at("arms").at("ur5").at("v"); };
    live.setJoints("ur5", {1.0, 1.0}, kNoon);
    live.setJoints("ur5", {2.0}, kNoon + 100ms);
    EXPECT_EQ(velocity(), json::array({0.0})) << "another arm under the same name";
    live.setJoints("ur5", {3.0}, kNoon + 100ms);
    EXPECT_EQ(velocity(), json::array({0.0}));
    live.setJoints("ur5", {4.0}, kNoon);
    EXPECT_EQ(velocity(), json::array({0.0})) << "a clock that was set back";
    live.setJoints("ur5", {4.5}, kNoon + 500ms);
    EXPECT_EQ(velocity(), json::array({1.0}));
}

TEST(LiveValuesOfAnArm, AreNotSentForLessThanAMillionth) {
    LiveValues live;
    live.setJoints("ur5", {1.0}, kNoon);
    live.changes(kNoon);
    live.setJoints("ur5", {1.0 + 1e-8}, kNoon + 500ms);
    EXPECT_TRUE(live.changes(kNoon).is_null());
}

TEST(Thinned, KeepsTheFirstAndTheLast) {
    EXPECT_EQ(thinned(0, 3, 101), 0U);
    EXPECT_EQ(thinned(1, 3, 101), 50U);
    EXPECT_EQ(thinned(2, 3, 101), 100U);
    EXPECT_EQ(thinned(0, 1, 101), 0U);
    for (std::size_t i = 0; i < 7; ++i) {
        EXPECT_EQ(thinned(i, 7, 7), i);
    }
}

}  // namespace
}  // namespace metier::dashboard
