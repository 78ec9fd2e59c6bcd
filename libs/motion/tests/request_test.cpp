// Requests that no arm could carry out, each with one thing wrong.
#include <fmt/format.h>
#include <gmock/gmock.h>

#include <array>
#include <cmath>
#include <limits>

#include "metier/motion/planner.hpp"
#include "test_robots.hpp"

namespace metier::motion {
namespace {

using testing::HasSubstr;

const std::array kNoLimits{-1.0, std::nan(""), std::numeric_limits<double>::infinity()};
const std::array kNoOverrides{0.0, -0.5, 1.0001, std::nan("")};

class Requests : public testing::Test {
protected:
    Requests() {
        ptp_.start = lin_.start = model_.home();
        JointVector target = model_.home();
        target[0] += 0.2;
        ptp_.target = target;
        lin_.reference = TargetReference::relative_base;
        lin_.target.translation = {0, 0, 0.05};
    }

    /// "code: text" of the refusal of a changed request; empty if it is planned.
    template <typename Change>
    std::string ptpWith(Change change) const {
        auto request = ptp_;
        change(request);
        return textOf(planner_.ptp(request));
    }
    template <typename Change>
    std::string linWith(Change change) const {
        auto request = lin_;
        change(request);
        return textOf(planner_.lin(request));
    }
    static std::string textOf(const Planned<Trajectory>& plan) {
        return plan ? std::string()
                    : fmt::format("{}: {}", toString(plan.error().error.code),
                                  plan.error().error.message);
    }

    const RobotModel model_ = loadRobot("ur5");
    const Planner planner_{model_};
    PtpRequest ptp_;
    LinRequest lin_;
};

TEST_F(Requests, ArePlannedAsTheyAre) {
    EXPECT_EQ(ptpWith([](auto&) {}), "");
    EXPECT_EQ(linWith([](auto&) {}), "");
}

TEST_F(Requests, NeedLimitsThatAreNumbersForEachAxisOrNone) {
    for (const double wrong : kNoLimits) {
        const auto limits = JointVector::constant(6, wrong);
        EXPECT_THAT(ptpWith([&](PtpRequest& r) { r.max_velocity = limits; }),
                    HasSubstr("out_of_range: max velocity"));
        EXPECT_THAT(ptpWith([&](PtpRequest& r) { r.max_acceleration = limits; }),
                    HasSubstr("out_of_range: max acceleration"));
        EXPECT_THAT(linWith([&](LinRequest& r) { r.max_velocity[5] = wrong; }),
                    HasSubstr("out_of_range: max velocity"));
        EXPECT_THAT(linWith([&](LinRequest& r) { r.max_acceleration[0] = wrong; }),
                    HasSubstr("out_of_range: max acceleration"));
    }
    EXPECT_THAT(ptpWith([](PtpRequest& r) { r.max_velocity = JointVector::constant(5, 1); }),
                HasSubstr("invalid_argument: max velocity: 5 values for 6 axes"));
    EXPECT_EQ(ptpWith([](PtpRequest& r) { r.max_velocity = JointVector(6); }), "")
        << "0: the robot's own";
}

TEST_F(Requests, NeedAShareOfTheSpeed) {
    for (const double wrong : kNoOverrides) {
        EXPECT_THAT(ptpWith([&](PtpRequest& r) { r.speed_override = wrong; }),
                    HasSubstr("out_of_range: speed override"));
        EXPECT_THAT(linWith([&](LinRequest& r) { r.speed_override = wrong; }),
                    HasSubstr("out_of_range: speed override"));
    }
    EXPECT_EQ(ptpWith([](PtpRequest& r) { r.speed_override = 1.0; }), "");
}

TEST_F(Requests, MayStartAMilliradianBeyondALimitAndNoFurther) {
    const auto from = [&](double beyond) {
        return ptpWith([&](PtpRequest& r) { r.start[0] = model_.limits(0).upper + beyond; });
    };
    EXPECT_EQ(from(0.9e-3), "");
    EXPECT_THAT(from(1.1e-3), HasSubstr("out_of_range: start: axis 1: 6.2843 rad over limit"));
    EXPECT_THAT(ptpWith([&](PtpRequest& r) { r.start[0] = model_.limits(0).lower - 0.1; }),
                HasSubstr("under limit"));
    EXPECT_THAT(ptpWith([](PtpRequest& r) { r.start[1] = std::nan(""); }),
                HasSubstr("invalid_argument: start: not 6 finite joint values"));
}

TEST_F(Requests, NeedATargetThatIsAPoseOrAJointPosition) {
    const auto to = [&](const auto& target) {
        return ptpWith([&](PtpRequest& r) { r.target = target; });
    };
    EXPECT_THAT(to(JointVector(7)), HasSubstr("not 6 finite joint values"));
    EXPECT_THAT(to(JointVector::constant(6, std::nan(""))), HasSubstr("invalid_argument"));
    EXPECT_THAT(to(JointVector::constant(6, 6.3)), HasSubstr("out_of_range"));
    Pose bent;
    bent.rotation.coeffs() *= 1.01;
    Pose none;
    none.rotation.coeffs().setZero();
    Pose lost;
    lost.translation.x() = std::numeric_limits<double>::infinity();
    for (const Pose& wrong : {bent, none, lost}) {
        EXPECT_THAT(to(wrong), HasSubstr("not a finite position and a unit quaternion"));
        EXPECT_THAT(linWith([&](LinRequest& r) { r.target = wrong; }),
                    HasSubstr("not a finite position and a unit quaternion"));
    }
}

TEST_F(Requests, NeedAnArmAngleThatIsANumberIfAny) {
    for (const double angle : {std::nan(""), HUGE_VAL}) {
        EXPECT_THAT(ptpWith([&](PtpRequest& r) { r.redundancy_angle = angle; }),
                    HasSubstr("arm angle"));
        EXPECT_THAT(linWith([&](LinRequest& r) { r.redundancy_angle = angle; }),
                    HasSubstr("arm angle"));
    }
}

TEST_F(Requests, NeedBoundsOfEachAxisWithAnUpperAndALowerEnd) {
    const auto within = [&](const JointVector& lower, const JointVector& upper) {
        return ptpWith([&](PtpRequest& r) { r.axis_bounds = {lower, upper}; });
    };
    const auto low = JointVector::constant(6, -6.0);
    const auto high = JointVector::constant(6, 6.0);
    EXPECT_EQ(within(low, high), "");
    EXPECT_THAT(within(low, JointVector::constant(5, 6.0)), HasSubstr("not 6 finite ranges"));
    EXPECT_THAT(within(JointVector::constant(6, std::nan("")), high),
                HasSubstr("not 6 finite ranges"));
    auto crossed = high;
    crossed[3] = -7.0;
    EXPECT_THAT(within(low, crossed),
                HasSubstr("axis bounds of axis 4: low -6 rad over high -7 rad"));
}

TEST_F(Requests, OfAPathNeedWaypointsThatCanBePassed) {
    const auto pathOf = [&](std::vector<PathWaypoint> waypoints) {
        return textOf(planner_.path({lin_, std::move(waypoints)}));
    };
    PathWaypoint up{lin_.target, 0.01};
    EXPECT_EQ(pathOf({up, up}), "");
    EXPECT_THAT(pathOf({}), HasSubstr("at least one waypoint"));
    for (const double wrong : kNoLimits) {
        auto slow = up;
        slow.max_velocity = wrong;
        EXPECT_THAT(pathOf({up, slow}), HasSubstr("out_of_range: waypoint velocity"));
        slow = up;
        slow.max_angular_velocity = wrong;
        EXPECT_THAT(pathOf({slow, up}), HasSubstr("out_of_range: waypoint velocity"));
        auto cut = up;
        cut.blend_radius = wrong;
        EXPECT_THAT(pathOf({cut, up}), HasSubstr("waypoint 1: blend radius"));
        EXPECT_EQ(pathOf({up, cut}), "") << "not used for the last one";
    }
}

}  // namespace
}  // namespace metier::motion
