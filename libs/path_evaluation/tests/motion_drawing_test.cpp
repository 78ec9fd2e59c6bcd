#include "metier/path_evaluation/motion_drawing.hpp"

#include <gmock/gmock.h>

#include <cmath>
#include <filesystem>
#include <limits>
#include <pugixml.hpp>

#include "metier/motion/planner.hpp"

namespace metier::path_evaluation {
namespace {

using ::testing::HasSubstr;

/// A PTP of every axis of a robot, sampled.
struct DrawnMotion {
    explicit DrawnMotion(const std::string& robot)
        : model(motion::RobotModel::load(std::filesystem::path(METIER_MODELS) / (robot + ".toml"))
                    .value()) {
        motion::PtpRequest request;
        request.start = model.home();
        auto target = model.home();
        for (double& value : target) {
            value -= 0.2;
        }
        request.target = target;
        const auto trajectory = motion::Planner(model).ptp(request).value();
        samples = sampleMotion(trajectory, 200);
        for (const auto& sample : samples) {
            positions.push_back(trajectory.toolPose(sample.position).translation);
        }
    }

    Result<std::string> draw(std::string title = "a") const {
        return drawMotion(model, {std::move(title), "note", samples, positions, 0.5});
    }

    motion::RobotModel model;
    std::vector<MotionSample> samples;
    std::vector<Eigen::Vector3d> positions;
};

pugi::xml_document parsed(const std::string& svg) {
    pugi::xml_document document;
    EXPECT_TRUE(document.load_string(svg.c_str()));
    return document;
}

TEST(DrawMotion, HasACurveOfEveryAxisAndQuantity) {
    const DrawnMotion motion("iiwa7");
    const auto document = parsed(motion.draw().value());
    for (const char* quantity : {"position", "velocity", "acceleration", "jerk"}) {
        for (int axis = 1; axis <= 7; ++axis) {
            const auto path = fmt::format("//polyline[@class='curve {} axis{}']", quantity, axis);
            const auto found = document.select_nodes(path.c_str());
            ASSERT_EQ(found.size(), 1U) << path;
            EXPECT_THAT(found.first().node().attribute("points").value(), HasSubstr(" "));
        }
    }
    EXPECT_EQ(document.select_nodes("//polyline[@class='curve path']").size(), 3U);
    EXPECT_EQ(document.select_nodes("//line[@class='limit']").size(), 9U);
}

TEST(DrawMotion, NamesAxesLimitsAndUnits) {
    const DrawnMotion motion("edo");
    const auto svg = motion.draw("e.DO & <co>").value();
    const auto document = parsed(svg);
    EXPECT_STREQ(document.select_node("//*[@class='title']").node().text().get(), "e.DO & <co>");
    for (const char* text : {"J6", "time / s", "rad/s²", "0.3978, peak "}) {
        EXPECT_THAT(svg, HasSubstr(text));
    }
}

TEST(DrawMotion, StaysInsideOfThePicture) {
    const DrawnMotion motion("ur5");
    const auto document = parsed(motion.draw().value());
    const double width = document.child("svg").attribute("width").as_double();
    const double height = document.child("svg").attribute("height").as_double();
    for (const auto& found : document.select_nodes("//text")) {
        const auto node = found.node();
        EXPECT_GE(node.attribute("x").as_double(), 0) << node.text().get();
        EXPECT_LE(node.attribute("x").as_double(), width) << node.text().get();
        EXPECT_LE(node.attribute("y").as_double(), height) << node.text().get();
    }
}

TEST(DrawMotion, DrawsAMotionThatStands) {
    DrawnMotion motion("ur5");
    motion.samples.resize(2);
    motion.samples[1] = motion.samples[0];
    motion.positions.assign(2, motion.positions[0]);
    const auto svg = motion.draw();
    ASSERT_TRUE(svg);
    EXPECT_THAT(*svg, ::testing::Not(HasSubstr("nan")));
}

TEST(DrawMotion, RefusesSamplesOfAnotherArm) {
    const DrawnMotion seven("iiwa7");
    const DrawnMotion six("ur5");
    const auto svg = drawMotion(six.model, {"", "", seven.samples, seven.positions, {}});
    ASSERT_FALSE(svg);
    EXPECT_THAT(svg.error().message, HasSubstr("7 joint positions, ur5 has 6 axes"));
}

TEST(DrawMotion, TheAskedSpeedIsALineOnlyIfThereIsOne) {
    const DrawnMotion motion("ur5");
    const auto without =
        drawMotion(motion.model, {"", "", motion.samples, motion.positions, {}}).value();
    EXPECT_EQ(parsed(without).select_nodes("//line[@class='limit']").size(), 8U);
    EXPECT_THAT(without, ::testing::Not(HasSubstr(">asked<")));
    EXPECT_THAT(motion.draw().value(), HasSubstr(">asked<"));
}

TEST(DrawMotion, ACurveFarBeyondItsLimitIsCutAndItsPeakStillReported) {
    DrawnMotion motion("ur5");
    motion.samples[50].velocity[2] = 10 * motion.model.limits(2).velocity;
    const auto svg = motion.draw().value();
    EXPECT_THAT(svg, HasSubstr("peak 1000.0 %: "));
    EXPECT_THAT(svg, HasSubstr(", peak 1000.0 %"));
    EXPECT_EQ(parsed(svg).select_nodes("//svg/svg").size(), 4U) << "each quantity is clipped";
}

TEST(DrawMotion, RefusesTooFewSamplesAndPositionsOfOtherSizes) {
    DrawnMotion motion("ur5");
    motion.positions.pop_back();
    EXPECT_THAT(motion.draw().error().message,
                HasSubstr("200 samples and 199 tool positions: at least 2 of each"));
    motion.samples.resize(1);
    motion.positions.resize(1);
    EXPECT_EQ(motion.draw().error().code, Errc::invalid_argument);
}

TEST(DrawMotion, RefusesWhatIsNotFiniteWithItsTime) {
    const double infinity = std::numeric_limits<double>::infinity();
    DrawnMotion jerky("ur5");
    jerky.samples[7].jerk[1] = infinity;
    const auto refused = jerky.draw();
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().code, Errc::invalid_argument);
    EXPECT_THAT(refused.error().message, HasSubstr("not finite at "));
    DrawnMotion lost("ur5");
    lost.positions[3].y() = std::nan("");
    EXPECT_FALSE(lost.draw());
}

}  // namespace
}  // namespace metier::path_evaluation
