// Commands of `metier` that need no server: fk, ik, check and plot.
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <gmock/gmock.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <numbers>
#include <pugixml.hpp>

#include "metier_program.hpp"

namespace metier::system_tests {
namespace {

using nlohmann::json;
using ::testing::AllOf;
using ::testing::Ge;
using ::testing::HasSubstr;
using ::testing::Le;
using ::testing::SizeIs;

constexpr int kSuccess = 0;
constexpr int kFailed = 1;
constexpr int kUsage = 2;
constexpr double kHalfPi = std::numbers::pi / 2;

std::string exact(double value) {
    return fmt::format("{}", value);
}

std::vector<std::string> commandLine(const char* command, const std::string& robot,
                                     const std::vector<double>& numbers) {
    std::vector<std::string> line{command, robot, "--json"};
    for (const double number : numbers) {
        line.push_back(exact(number));
    }
    return line;
}

json jsonOf(const std::vector<std::string>& line, int status = kSuccess) {
    const auto finished = runMetier(line, Errors::left_out);
    EXPECT_EQ(finished.status, status) << finished.output;
    return json::parse(finished.output);
}

/// A file of the test, removed at its end.
class ScratchFile {
public:
    explicit ScratchFile(const std::string& name)
        : path_(std::filesystem::path(::testing::TempDir()) / (std::to_string(getpid()) + name)) {}
    ~ScratchFile() { std::filesystem::remove(path_); }
    ScratchFile(const ScratchFile&) = delete;
    ScratchFile& operator=(const ScratchFile&) = delete;

    std::string name() const { return path_.string(); }

private:
    std::filesystem::path path_;
};

/// Joint positions and the flange's pose there: computed by KDL from DH parameters and by a second
/// implementation from the makers' joint origins, which agree to 6e-16.
struct KnownPose {
    const char* name;
    const char* robot;
    std::vector<double> joints;
    std::vector<double> position;    ///< x y z [m]
    std::vector<double> quaternion;  ///< w x y z
};

void PrintTo(const KnownPose& pose, std::ostream* out) {
    *out << pose.name;
}

std::vector<KnownPose> knownPoses() {
    const double s = std::numbers::sqrt2 / 2;
    const std::vector<double> ur_work{0.6108652381980153, -1.3089969389957472, 1.7453292519943295,
                                      -2.007128639793479, -1.5707963267948966, 0.3490658503988659};
    const std::vector<double> kuka_home{0, 0.5235987755982988, 0, -1.5707963267948966,
                                        0, 1.0471975511965976, 0};
    const std::vector<double> kuka_work{
        -0.4363323129985824, 0.6981317007977318, 0.2617993877991494, -1.3962634015954636,
        -0.5235987755982988, 0.9599310885968813, 1.7453292519943295};
    const std::vector<double> kuka_turn{0.139607111179, 0.745974768775, 0.648561852745,
                                        -0.058301132272};
    return {
        {"Ur5Zero", "ur5", std::vector<double>(6), {-0.81725, -0.19145, -0.005491}, {s, s, 0, 0}},
        {"Ur5Home",
         "ur5",
         {0, -kHalfPi, 0, -kHalfPi, 0, 0},
         {0, -0.19145, 1.001059},
         {0, 0, s, -s}},
        {"Ur5Work",
         "ur5",
         ur_work,
         {-0.396239957230, -0.410697751356, 0.251605463005},
         {0, 0.608761429009, 0.793353340291, 0}},
        {"Ur5eZero", "ur5e", std::vector<double>(6), {-0.8172, -0.2329, 0.0628}, {s, s, 0, 0}},
        {"Ur5eHome", "ur5e", {0, -kHalfPi, 0, -kHalfPi, 0, 0}, {0, -0.2329, 1.0794}, {0, 0, s, -s}},
        {"Ur5eWork",
         "ur5e",
         ur_work,
         {-0.386487683922, -0.433350842389, 0.307667593918},
         {0, 0.608761429009, 0.793353340291, 0}},
        {"Iiwa7Zero", "iiwa7", std::vector<double>(7), {0, 0, 1.266}, {1, 0, 0, 0}},
        {"Iiwa7Home", "iiwa7", kuka_home, {0.546410161514, 0, 0.360410161514}, {0, 0, 1, 0}},
        {"Iiwa7Work",
         "iiwa7",
         kuka_work,
         {0.592605888809, -0.194085579449, 0.334813731118},
         kuka_turn},
        {"Iiwa14Zero", "iiwa14", std::vector<double>(7), {0, 0, 1.306}, {1, 0, 0, 0}},
        {"Iiwa14Home", "iiwa14", kuka_home, {0.556410161514, 0, 0.397730669589}, {0, 0, 1, 0}},
        {"Iiwa14Work",
         "iiwa14",
         kuka_work,
         {0.604257157130, -0.199518655094, 0.370134619980},
         kuka_turn},
        {"EdoZero", "edo", std::vector<double>(6), {0, 0, 0.99}, {1, 0, 0, 0}},
        {"EdoBent", "edo", {0, 0, kHalfPi, 0, 0, 0}, {0.4425, 0, 0.5475}, {s, 0, s, 0}},
        {"EdoWork",
         "edo",
         {0.5235987755982988, -0.4363323129985824, 1.6580627893946132, 0.6981317007977318,
          1.0471975511965976, -1.2217304763960306},
         {0.197779117461, 0.226354264596, 0.540496239150},
         {0.489713959031, -0.633241448106, 0.570265577060, 0.184343913247}},
    };
}

class Kinematics : public ::testing::TestWithParam<KnownPose> {
protected:
    static json fk() { return jsonOf(commandLine("fk", GetParam().robot, GetParam().joints)); }
    static json ik() {
        const auto pose = fk();
        const auto& at = pose.at("position");
        const auto& turned = pose.at("rotation");
        return jsonOf(
            commandLine("ik", GetParam().robot,
                        {at["x"], at["y"], at["z"], turned["a"], turned["b"], turned["c"]}));
    }
};

TEST_P(Kinematics, FkGivesThePublishedPose) {
    const auto pose = fk();
    constexpr std::array axes{"x", "y", "z"};
    for (std::size_t i = 0; i < 3; ++i) {
        EXPECT_NEAR(pose["position"][axes.at(i)].get<double>(), GetParam().position[i], 1e-11);
    }
    constexpr std::array components{"w", "x", "y", "z"};
    for (std::size_t i = 0; i < 4; ++i) {
        EXPECT_NEAR(pose["quaternion"][components.at(i)].get<double>(), GetParam().quaternion[i],
                    1e-11)
            << components.at(i);
    }
    EXPECT_EQ(pose["joint_position"].get<std::vector<double>>(), GetParam().joints);
}

TEST_P(Kinematics, EverySolutionOfIkReachesThePose) {
    const auto solved = ik();
    ASSERT_THAT(solved["solutions"], SizeIs(AllOf(Ge(1), Le(8))));
    for (const auto& solution : solved["solutions"]) {
        const auto reached = jsonOf(commandLine(
            "fk", GetParam().robot, solution["joint_position"].get<std::vector<double>>()));
        for (const char* axis : {"x", "y", "z"}) {
            EXPECT_NEAR(reached["position"][axis].get<double>(),
                        solved["position"][axis].get<double>(), 1e-10);
        }
        for (const char* component : {"w", "x", "y", "z"}) {
            EXPECT_NEAR(std::abs(reached["quaternion"][component].get<double>()),
                        std::abs(solved["quaternion"][component].get<double>()), 1e-9);
        }
        EXPECT_EQ(solution["within_limits"], reached["within_limits"]);
        EXPECT_LT(solution["position_residual"].get<double>(), 1e-10);
        EXPECT_LT(solution["rotation_residual"].get<double>(), 1e-10);
    }
}

INSTANTIATE_TEST_SUITE_P(Robots, Kinematics, ::testing::ValuesIn(knownPoses()),
                         [](const auto& test) { return std::string(test.param.name); });

/// Largest difference of two joint positions, but for whole turns [rad].
double differenceOf(const std::vector<double>& a, const std::vector<double>& b) {
    double largest = 0;
    for (std::size_t i = 0; i < a.size(); ++i) {
        largest = std::max(largest, std::abs(std::remainder(a[i] - b[i], 2 * std::numbers::pi)));
    }
    return largest;
}

bool holds(const json& solutions, const std::vector<double>& joints) {
    return std::any_of(solutions.begin(), solutions.end(), [&](const json& solution) {
        return differenceOf(solution["joint_position"].get<std::vector<double>>(), joints) < 1e-9;
    });
}

TEST(Ik, FindsAllEightBranchesAndTheOneItCameFrom) {
    for (const auto& known : knownPoses()) {
        if (std::string(known.name).find("Work") == std::string::npos || known.joints.size() > 6) {
            continue;
        }
        const auto pose = jsonOf(commandLine("fk", known.robot, known.joints));
        const auto& at = pose["position"];
        const auto& turned = pose["rotation"];
        const auto solved = jsonOf(commandLine(
            "ik", known.robot, {at["x"], at["y"], at["z"], turned["a"], turned["b"], turned["c"]}));
        EXPECT_THAT(solved["solutions"], SizeIs(8)) << known.name;
        EXPECT_TRUE(holds(solved["solutions"], known.joints)) << known.name;
    }
}

TEST(Ik, OfASevenAxisArmHasTheArmAngleOfTheReferenceOrTheOneThatIsAsked) {
    const auto known = knownPoses()[8];
    const auto pose = jsonOf(commandLine("fk", known.robot, known.joints));
    const auto& at = pose["position"];
    const auto& turned = pose["rotation"];
    auto line = commandLine("ik", known.robot,
                            {at["x"], at["y"], at["z"], turned["a"], turned["b"], turned["c"]});
    EXPECT_EQ(jsonOf(line)["arm_angle"], 0.0);
    EXPECT_FALSE(holds(jsonOf(line)["solutions"], known.joints));
    auto with_reference = line;
    with_reference.insert(with_reference.end(),
                          {"--reference", fmt::format("{}", fmt::join(known.joints, ","))});
    const auto as_reference = jsonOf(with_reference);
    EXPECT_THAT(as_reference["solutions"], SizeIs(8));
    EXPECT_TRUE(holds(as_reference["solutions"], known.joints));
    line.insert(line.end(), {"--arm-angle", exact(as_reference["arm_angle"])});
    EXPECT_TRUE(holds(jsonOf(line)["solutions"], known.joints));
}

TEST(Ik, MarksSolutionsOutsideOfTheLimits) {
    const auto solved = jsonOf({"ik", "iiwa7", "0.546410161514", "0", "0.360410161514", "0",
                                "3.141592653589793", "0", "--json"});
    int within = 0;
    for (const auto& solution : solved["solutions"]) {
        within += solution["within_limits"].get<bool>() ? 1 : 0;
    }
    EXPECT_THAT(within, AllOf(Ge(1), Le(7)));
}

std::string replaced(std::string text, const std::string& what, const std::string& by) {
    return text.replace(text.find(what), what.size(), by);
}

TEST(Ik, TurnsAnAxisIntoItsLimitsByAWholeTurn) {
    std::ifstream edo(std::string(METIER_SOURCE_DIR) + "/models/edo.toml");
    std::string text((std::istreambuf_iterator<char>(edo)), std::istreambuf_iterator<char>());
    text = replaced(std::move(text), "home = [0.0", "home = [1.0");
    text = replaced(std::move(text), "position_deg = [-179, 179]", "position_deg = [10, 350]");
    const ScratchFile model(".toml");
    std::ofstream(model.name()) << text;
    const std::vector<double> joints{5.0, -0.4, 1.6, 0.7, 1.0, -1.2};
    const auto pose = jsonOf(commandLine("fk", model.name(), joints));
    const auto& at = pose["position"];
    const auto& turned = pose["rotation"];
    const auto solved = jsonOf(commandLine(
        "ik", model.name(), {at["x"], at["y"], at["z"], turned["a"], turned["b"], turned["c"]}));
    const auto& solutions = solved["solutions"];
    EXPECT_TRUE(std::any_of(solutions.begin(), solutions.end(), [](const json& solution) {
        return std::abs(solution["joint_position"][0].get<double>() - 5.0) < 1e-9 &&
               solution["within_limits"].get<bool>();
    })) << solutions.dump(2);
}

TEST(Ik, OfAPoseOutOfReachFailsWithDistanceAndReach) {
    const auto far = runMetier({"ik", "ur5", "2", "0", "0", "0", "0", "0"});
    EXPECT_EQ(far.status, kFailed);
    EXPECT_THAT(far.output, AllOf(HasSubstr("the wrist would be 1.9101 m from axis 2"),
                                  HasSubstr("reach 0.8173 m")));
    const auto answer = jsonOf({"ik", "ur5", "2", "0", "0", "0", "0", "0", "--json"}, kFailed);
    EXPECT_THAT(answer["solutions"], SizeIs(0));
    EXPECT_THAT(answer["error"].get<std::string>(), HasSubstr("unreachable"));
}

TEST(Fk, TakesNegativeNumbersInEverySpelling) {
    const auto plain = jsonOf({"fk", "ur5", "-1.57", "0", "-0.5", "0", "-0.001", "0", "--json"});
    for (const auto& line : std::vector<std::vector<std::string>>{
             {"fk", "ur5", "-1.57", "0", "-.5", "0", "-1e-3", "-0", "--json"},
             {"fk", "--json", "ur5", "--", "-1.57", "0", "-5e-1", "0", "-.001", "0"},
             {"fk", "ur5", "-1.57,0,-.5,0,-1e-3,0", "--json"}}) {
        EXPECT_EQ(jsonOf(line)["position"], plain["position"]);
    }
}

TEST(Fk, TakesAFileAndTellsThatLimitsAreBroken) {
    const auto model = std::string(METIER_SOURCE_DIR) + "/models/edo.toml";
    const auto pose = runMetier({"fk", model, "0", "0", "1.9", "0", "0", "0"});
    EXPECT_EQ(pose.status, kSuccess);
    EXPECT_THAT(pose.output,
                AllOf(HasSubstr("quaternion  w 0.581683089464"), HasSubstr("outside of the")));
}

/// A command line that is refused as wrong, and what is said.
struct WrongLine {
    const char* name;
    std::vector<std::string> line;
    std::vector<std::string> parts;
};

void PrintTo(const WrongLine& wrong, std::ostream* out) {
    *out << wrong.name;
}

class BadLine : public ::testing::TestWithParam<WrongLine> {};

TEST_P(BadLine, IsUsageAndTellsTheValueAndWhatIsAllowed) {
    const auto refused = runMetier(GetParam().line);
    EXPECT_EQ(refused.status, kUsage) << refused.output;
    for (const auto& part : GetParam().parts) {
        EXPECT_THAT(refused.output, HasSubstr(part));
    }
}

INSTANTIATE_TEST_SUITE_P(
    Commands, BadLine,
    ::testing::Values(
        WrongLine{"UnknownRobot", {"fk", "ur6", "0"}, {"'ur6'", "edo, iiwa14, iiwa7, ur5, ur5e"}},
        WrongLine{"NoSuchModelFile", {"ik", "./ur6.toml", "0"}, {"./ur6.toml"}},
        WrongLine{"TooFewJoints", {"fk", "ur5", "0", "0"}, {"2 values", "6 axes"}},
        WrongLine{"TooManyJoints", {"fk", "edo", "0,0,0,0,0,0,0"}, {"7 values", "6 axes"}},
        WrongLine{"NanJoint", {"fk", "ur5", "0", "nan", "0", "0", "0", "0"}, {"2: 'nan'"}},
        WrongLine{"NegativeNanJoint", {"fk", "ur5", "0", "0", "-nan"}, {"3: '-nan'"}},
        WrongLine{"InfiniteJoint", {"fk", "ur5", "-inf"}, {"1: '-inf'"}},
        WrongLine{"NoJoints", {"fk", "ur5"}, {"joints"}},
        WrongLine{"PoseOfFive", {"ik", "ur5", "0", "0", "0", "0", "0"}, {"5 values", "6: x y z"}},
        WrongLine{"PoseOfWords", {"ik", "ur5", "a", "0", "0", "0", "0", "0"}, {"pose 1: 'a'"}},
        WrongLine{"NoArmAngle",
                  {"ik", "ur5", "0.4,0,0.3,0,0,0", "--arm-angle", "1"},
                  {"ur5 has no arm angle"}},
        WrongLine{"WrongReference",
                  {"ik", "ur5", "0.4,0,0.3,0,0,0", "--reference", "1,2"},
                  {"reference: 2 values"}},
        WrongLine{"UnknownTool", {"fk", "ur5", "0,0,0,0,0,0", "--tool", "hand"}, {"hand"}},
        WrongLine{"NoTarget", {"check", "ur5"}, {"--to-pose or --to-joints"}},
        WrongLine{"TwoTargets",
                  {"check", "ur5", "--to-pose", "0,0,0,0,0,0", "--to-joints", "0,0,0,0,0,0"},
                  {"excludes"}},
        WrongLine{"SeveralPtpTargets",
                  {"check", "ur5", "--to-pose", "0,0,0,0,0,0", "--to-pose", "0,0,0,0,0,0"},
                  {"--linear"}},
        WrongLine{"NanTarget", {"check", "ur5", "--to-joints", "0,0,0,nan,0,0"}, {"4: 'nan'"}},
        WrongLine{"BadBounds",
                  {"check", "ur5", "--to-pose", "0,0,0,0,0,0", "--axis-bounds", "1,2"},
                  {"low:high"}},
        WrongLine{"RecordAndTarget",
                  {"plot", "ur5", "--record", "a.csv", "--to-joints", "0,0,0,0,0,0"},
                  {"--record"}},
        WrongLine{"NoSuchRecord", {"plot", "ur5", "--record", "none.csv"}, {"none.csv"}},
        WrongLine{"PictureThatCannotBeWritten",
                  {"plot", "ur5", "--to-joints", "0,-1,1,0,1,0", "--svg", "/nonexistent/a.svg"},
                  {"/nonexistent/a.svg"}}),
    [](const auto& test) { return std::string(test.param.name); });

const std::vector<std::string> kDown{"ur5",        "--to-pose", "0,0,-0.1,0,0,0",
                                     "--relative", "base",      "--linear"};

std::vector<std::string> with(std::vector<std::string> line, const std::string& command,
                              const std::vector<std::string>& more = {}) {
    line.insert(line.begin(), command);
    line.insert(line.end(), more.begin(), more.end());
    return line;
}

TEST(Check, TellsDurationPeaksAndAPreviewOfAPossibleMove) {
    const auto move = jsonOf(with(kDown, "check", {"--json", "--points", "11"}));
    EXPECT_EQ(move["possible"], true);
    EXPECT_EQ(move["move"], "CartesianLinearMoveSkill");
    EXPECT_NEAR(move["length"].get<double>(), 0.1, 1e-12);
    EXPECT_GT(move["duration"].get<double>(), 0.1);
    ASSERT_THAT(move["preview"], SizeIs(11));
    EXPECT_LT(differenceOf(move["preview"][0]["joint_position"], move["start"]), 1e-12);
    EXPECT_EQ(move["preview"][10]["joint_position"], move["end"]);
    EXPECT_EQ(move["preview"][10]["time"], move["duration"]);
    for (const char* quantity : {"velocity", "acceleration", "jerk"}) {
        EXPECT_THAT(move["peaks"][quantity]["share"].get<double>(), AllOf(Ge(0.01), Le(1.000001)));
    }
    const auto text = runMetier(with(kDown, "check"));
    EXPECT_EQ(text.status, kSuccess);
    EXPECT_THAT(text.output, ::testing::StartsWith("possible: takes "));
}

TEST(Check, ASlowerMoveTakesLonger) {
    const auto quick = jsonOf(with(kDown, "check", {"--json"}));
    for (const auto& more : std::vector<std::vector<std::string>>{
             {"--max-velocity", "0.05"}, {"--max-acceleration", "0.05"}, {"--override", "0.1"}}) {
        auto line = with(kDown, "check", more);
        line.emplace_back("--json");
        EXPECT_GT(jsonOf(line)["duration"].get<double>(), 1.5 * quick["duration"].get<double>())
            << more.front();
    }
}

TEST(Check, RefusesWithReasonPlaceAndExitStatus) {
    const auto refused = runMetier({"check", "edo", "--to-joints", "0,0,1.8,0,0,0"});
    EXPECT_EQ(refused.status, kFailed);
    EXPECT_THAT(refused.output,
                AllOf(HasSubstr("refused: target: axis 3: 1.8000 rad over limit"),
                      HasSubstr("reason        joint_limit"), HasSubstr("axis          3")));
    const auto answer = jsonOf(
        {"check", "ur5", "--to-pose", "0,0,-1,0,0,0", "--relative", "base", "--linear", "--json"},
        kFailed);
    EXPECT_EQ(answer["possible"], false);
    EXPECT_FALSE(answer.contains("duration"));
    EXPECT_THAT(answer["refusal"]["fraction"].get<double>(), AllOf(Ge(0.5), Le(0.99)));
    EXPECT_TRUE(answer["refusal"]["axis"].is_null());
}

TEST(Check, RefusesWhatTheServerWouldNotTake) {
    const auto refused =
        runMetier({"check", "ur5", "--to-joints", "0,-1,1,0,1,0", "--max-velocity", "25"});
    EXPECT_EQ(refused.status, kFailed);
    EXPECT_THAT(refused.output, HasSubstr("25 rad/s is over the limit 20 rad/s"));
}

TEST(Check, AnswersAsTheServerDoesFromTheSameJoints) {
    const ServerProcess server("iiwa");
    const auto client = connectTo(server.url());
    const auto skill = openSkill(*client, "CartesianLinearMoveSkill");
    for (const char* target : {"0.05,0.05,0.05,0,0,0", "1,0,0,0,0,0", "-0.9,0,0,0,0,0"}) {
        const auto start = fmt::format("{}", fmt::join(jointPosition(*client, skill), ","));
        const auto checked = runMetier({"check", "iiwa7", "--from", start, "--to-pose", target,
                                        "--relative", "base", "--linear"});
        const auto run =
            runMetier({"run", server.url(), "CartesianLinearMoveSkill", "--set",
                       std::string("TargetPosition=") + target, "--set", "Relative=1"});
        EXPECT_EQ(checked.status, run.status) << checked.output << run.output;
        if (checked.status == kFailed) {
            const auto end = checked.output.find('\n');
            EXPECT_THAT(run.output, HasSubstr(checked.output.substr(9, end - 9)));
        }
    }
}

TEST(Check, PlansAPathWithRoundedCorners) {
    std::vector<std::string> line{"check",      "iiwa7",         "--json",    "--linear",
                                  "--relative", "base",          "--to-pose", "0,0.1,0,0,0,0",
                                  "--to-pose",  "0,0,0.1,0,0,0", "--blend",   "0.03"};
    const auto path = jsonOf(line);
    EXPECT_EQ(path["move"], "CartesianPathMoveSkill");
    EXPECT_THAT(path["length"].get<double>(), AllOf(Ge(0.15), Le(0.2)));
    line.back() = "0";
    const auto refused = jsonOf(line, kFailed);
    EXPECT_THAT(refused["refusal"]["message"].get<std::string>(), HasSubstr("blend radius 0 m"));
}

pugi::xml_document drawn(const std::vector<std::string>& line) {
    const ScratchFile file(".svg");
    auto with_file = line;
    with_file.insert(with_file.end(), {"--svg", file.name()});
    const auto finished = runMetier(with_file);
    EXPECT_EQ(finished.status, kSuccess) << finished.output;
    pugi::xml_document document;
    EXPECT_TRUE(document.load_file(file.name().c_str()));
    return document;
}

void expectEveryCurve(const pugi::xml_document& document, int axes) {
    for (const char* quantity : {"position", "velocity", "acceleration", "jerk"}) {
        for (int axis = 1; axis <= axes; ++axis) {
            const auto path = fmt::format("//polyline[@class='curve {} axis{}']", quantity, axis);
            EXPECT_EQ(document.select_nodes(path.c_str()).size(), 1U) << path;
        }
    }
    EXPECT_EQ(document.select_nodes("//polyline[@class='curve path']").size(), 3U);
}

TEST(Plot, HoldsTheCurvesOfEveryAxis) {
    expectEveryCurve(drawn(with(kDown, "plot")), 6);
    expectEveryCurve(drawn({"plot", "iiwa14", "--to-joints", "0,0,0,-1,0,1,0"}), 7);
}

TEST(Plot, DrawsWhatCheckHasWritten) {
    const ScratchFile csv(".csv");
    const auto written = jsonOf(with(kDown, "check", {"--json", "--csv", csv.name()}));
    const ScratchFile preview(".json");
    std::ofstream(preview.name()) << written.dump();
    for (const auto& record : {csv.name(), preview.name()}) {
        const auto document = drawn({"plot", "ur5", "--record", record, "--title", "a & b"});
        expectEveryCurve(document, 6);
        EXPECT_STREQ(document.select_node("//*[@class='title']").node().text().get(), "a & b");
    }
}

TEST(Plot, RefusesAMoveThatIsNotPossibleAndARecordOfAnotherArm) {
    const auto refused = runMetier({"plot", "edo", "--to-joints", "0,0,1.8,0,0,0"});
    EXPECT_EQ(refused.status, kFailed);
    EXPECT_THAT(refused.output, HasSubstr("axis 3: 1.8000 rad over limit"));
    const ScratchFile csv(".csv");
    ASSERT_EQ(runMetier(with(kDown, "check", {"--csv", csv.name()})).status, kSuccess);
    const auto other = runMetier({"plot", "iiwa7", "--record", csv.name()});
    EXPECT_EQ(other.status, kUsage);
    EXPECT_THAT(other.output, HasSubstr("6 joint positions, iiwa7 has 7 axes"));
}

}  // namespace
}  // namespace metier::system_tests
