#include "metier/robot_files/import.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "chain_choice.hpp"
#include "home_search.hpp"
#include "joint_rows.hpp"
#include "model_text.hpp"
#include "shapes.hpp"

namespace metier::robot_files {

namespace {

using motion::ChainDescription;
using motion::IkKind;
using motion::JointVector;
using motion::RobotModel;

constexpr double kCycleTime = 0.008;  // [s]
/// Slow enough for any arm; the speed of a manual mode (ISO 10218-1: 250 mm/s).
constexpr motion::CartesianLimits kCartesian{.velocity = 0.25,
                                             .acceleration = 1.0,
                                             .jerk = 20.0,
                                             .angular_velocity = 0.5,
                                             .angular_acceleration = 2.0,
                                             .angular_jerk = 40.0};

/// The frames of a chain in place of its own.
ChainDescription withFrames(ChainDescription chain, const ChainFrames& frames) {
    for (std::size_t i = 0; i < chain.joints.size(); ++i) {
        chain.joints[i].parent_from_joint = frames.parent_from_joint[i];
        chain.joints[i].axis = frames.axis[i];
    }
    chain.last_from_flange = frames.last_from_flange;
    return chain;
}

JointVector middleOf(const std::vector<motion::JointDescription>& joints) {
    JointVector middle(joints.size());
    for (std::size_t i = 0; i < joints.size(); ++i) {
        middle[i] = (joints[i].limits.lower + joints[i].limits.upper) / 2;
    }
    return middle;
}

/// Largest distance of the flanges of two chains over many joint positions [m].
double farthest(const RobotModel& one, const RobotModel& other) {
    constexpr int tried = 500;
    constexpr double golden = 0.618033988749895;
    double most = 0;
    for (int n = 1; n <= tried; ++n) {
        JointVector q(one.axisCount());
        for (std::size_t i = 0; i < q.size(); ++i) {
            const double share = std::fmod(golden * n * static_cast<double>(2 * i + 1), 1.0);
            q[i] = one.limits(i).lower + share * (one.limits(i).upper - one.limits(i).lower);
        }
        most = std::max(most, motion::distanceBetween(one.kinematics().forward(q),
                                                      other.kinematics().forward(q)));
    }
    return most;
}

Result<void> checkCount(const std::vector<double>& values, std::size_t axes, const char* option) {
    if (values.size() > 1 && values.size() != axes) {
        return fail(Errc::invalid_argument,
                    fmt::format("{}: {} values for {} axes", option, values.size(), axes));
    }
    for (const double value : values) {
        if (!std::isfinite(value) || value <= 0.0) {
            return fail(Errc::invalid_argument, fmt::format("{}: {} is not over 0", option, value));
        }
    }
    return {};
}

Result<void> checkOptions(const ImportOptions& options, std::size_t axes) {
    METIER_TRY(checkCount(options.velocity, axes, "velocity"));
    METIER_TRY(checkCount(options.acceleration, axes, "acceleration"));
    METIER_TRY(checkCount(options.jerk, axes, "jerk"));
    if (!options.home.empty() && options.home.size() != axes) {
        return fail(Errc::invalid_argument,
                    fmt::format("home: {} values for {} axes", options.home.size(), axes));
    }
    const double cycle = options.cycle_time.value_or(kCycleTime);
    if (!std::isfinite(cycle) || cycle <= 0) {
        return fail(Errc::invalid_argument, fmt::format("cycle time: {} s is not over 0", cycle));
    }
    const auto& range = options.position;
    if (!range.empty() && (range.size() != 2 || !std::isfinite(range[0]) ||
                           !std::isfinite(range[1]) || range[0] >= range[1])) {
        return fail(Errc::invalid_argument,
                    "position: not a lower and an upper limit, the lower one first");
    }
    return {};
}

class Importer {
public:
    Importer(XmlFile& file, const RobotTree& tree, const ImportOptions& options)
        : file_(file), tree_(tree), options_(options) {}

    /// Takes groups, states and pairs from an SRDF file, too.
    void use(const Semantics& semantics) { semantics_ = &semantics; }
    Result<ImportedRobot> run();

private:
    struct Read {
        motion::RobotAppearance appearance;
        ChainDescription chain;
        ChainFrames other_frames;  ///< with the angles taken the other way
    };

    Result<ChainEnds> ends();
    Result<Read> read(const ChainChoice& choice);
    motion::RobotAppearance names();
    Result<JointVector> home(const ChainDescription& chain);
    std::optional<JointVector> stateHome(const ChainDescription& chain);
    Result<void> compareAngles(const ChainDescription& chain, const ChainFrames& other);
    std::vector<std::string> comments() const;

    XmlFile& file_;
    const RobotTree& tree_;
    const ImportOptions& options_;
    const Semantics* semantics_ = nullptr;
    std::string chain_text_;
    std::vector<std::string> assumed_;
    std::vector<std::string> left_out_;
    std::vector<std::string> remarks_;
};

Result<ChainEnds> Importer::ends() {
    ChainEnds ends{options_.base, options_.tip};
    const auto groups = semantics_ == nullptr ? std::vector<ChainGroup>{} : semantics_->groups();
    const auto group = std::find_if(groups.begin(), groups.end(), [&](const ChainGroup& known) {
        return options_.group.empty() ? groups.size() == 1 : known.name == options_.group;
    });
    if (group == groups.end()) {
        if (options_.group.empty()) {
            return ends;
        }
        std::vector<std::string> names;
        for (const auto& known : groups) {
            names.push_back(known.name);
        }
        return fail(
            Errc::invalid_argument,
            fmt::format("no group \"{}\" that is a chain{}", options_.group,
                        names.empty() ? std::string()
                                      : fmt::format("; there are: {}", fmt::join(names, ", "))));
    }
    if (ends.base.empty() && ends.tip.empty()) {
        ends = {group->base, group->tip};
        remarks_.push_back(
            fmt::format("base and tip are those of the SRDF group \"{}\"", group->name));
    }
    return ends;
}

motion::RobotAppearance Importer::names() {
    motion::RobotAppearance appearance;
    const auto stem = [&] {
        const auto& path = file_.name();
        const auto slash = path.rfind('/');
        const auto name = path.substr(slash == std::string::npos ? 0 : slash + 1);
        return name.substr(0, name.find('.'));
    };
    const std::string in_file = file_.root().attribute("name").value();
    appearance.name = !options_.name.empty() ? options_.name : !in_file.empty() ? in_file : stem();
    const auto given = [&](const std::string& option, const char* what) {
        if (option.empty()) {
            assumed_.push_back(fmt::format("{} \"unknown\"", what));
        }
        return option.empty() ? std::string("unknown") : option;
    };
    appearance.maker = given(options_.maker, "maker");
    appearance.product = options_.product.empty() ? appearance.name : options_.product;
    return appearance;
}

Result<Importer::Read> Importer::read(const ChainChoice& choice) {
    const auto taken = options_.round_angles ? Angles::rounded : Angles::as_written;
    const auto other = options_.round_angles ? Angles::as_written : Angles::rounded;
    const ChosenChain chain{file_, tree_, choice};
    Read read;
    read.appearance = names();
    read.chain.joints = readAxes(chain, options_, assumed_);
    const auto frames = readFrames(chain, taken);
    read.chain = withFrames(std::move(read.chain), frames);
    read.other_frames = readFrames(chain, other);
    const auto groups = groupLinks(chain, taken);
    read.chain.tools = readTools(chain, taken, left_out_);
    readShapes(chain, groups, read.appearance, left_out_);
    METIER_TRY(file_.finish());
    for (auto& text : jointsBeside(chain, groups)) {
        left_out_.push_back(std::move(text));
    }
    if (semantics_ != nullptr) {
        read.appearance.not_compared = readUncompared(tree_, groups, *semantics_, remarks_);
    }
    if (read.appearance.capsules.empty()) {
        remarks_.emplace_back("without capsules self-collision is not checked");
    }
    read.chain.cycle_time = options_.cycle_time.value_or(kCycleTime);
    read.chain.cartesian_limits = kCartesian;
    if (!options_.cycle_time) {
        assumed_.push_back(fmt::format("cycle time of {} s", kCycleTime));
    }
    assumed_.push_back(fmt::format(
        "Cartesian limits of {} m/s, {} m/s2, {} m/s3, {} rad/s, {} rad/s2, {} rad/s3",
        kCartesian.velocity, kCartesian.acceleration, kCartesian.jerk, kCartesian.angular_velocity,
        kCartesian.angular_acceleration, kCartesian.angular_jerk));
    return read;
}

/// The state "home" of the SRDF file, if it names each axis and is within the limits.
std::optional<JointVector> Importer::stateHome(const ChainDescription& chain) {
    if (semantics_ == nullptr) {
        return std::nullopt;
    }
    const auto& state = semantics_->state("home");
    JointVector home(chain.joints.size());
    for (std::size_t i = 0; i < home.size(); ++i) {
        const auto& joint = chain.joints[i];
        const auto value = state.find(joint.name);
        if (value == state.end()) {
            return std::nullopt;
        }
        if (value->second < joint.limits.lower || value->second > joint.limits.upper) {
            remarks_.push_back(fmt::format(
                "the SRDF state \"home\" is not used: {} rad is outside {} to {} rad of axis {}",
                value->second, joint.limits.lower, joint.limits.upper, i + 1));
            return std::nullopt;
        }
        home[i] = value->second;
    }
    return home;
}

Result<JointVector> Importer::home(const ChainDescription& chain) {
    if (!options_.home.empty()) {
        return JointVector::from(options_.home);
    }
    if (const auto state = stateHome(chain)) {
        return *state;
    }
    METIER_ASSIGN(const auto model, RobotModel::fromChain(chain));
    assumed_.emplace_back("home: a position far from singularities, found by a search");
    return searchHome(model);
}

/// Reports what rounded angles change, or would change.
Result<void> Importer::compareAngles(const ChainDescription& chain, const ChainFrames& other) {
    METIER_ASSIGN(const auto taken, RobotModel::fromChain(chain));
    METIER_ASSIGN(const auto otherwise, RobotModel::fromChain(withFrames(chain, other)));
    const double millimetres = 1000 * farthest(taken, otherwise);
    if (options_.round_angles) {
        remarks_.push_back(
            fmt::format("rounded angles move the flange by up to {:.4f} mm", millimetres));
        return {};
    }
    const auto isClosed = [](const RobotModel& model) {
        return model.kinematics().ikKind() != IkKind::numeric && !model.kinematics().isCalibrated();
    };
    if (!isClosed(taken) && isClosed(otherwise)) {
        remarks_.push_back(fmt::format(
            "angles are written with few digits: with --round-angles {} (the flange moves by up "
            "to {:.4f} mm)",
            planningOf(otherwise), millimetres));
    }
    return {};
}

std::vector<std::string> Importer::comments() const {
    std::vector<std::string> lines{
        fmt::format("Made from {} by metier robot import; {}.", file_.name(), chain_text_)};
    const auto list = [&](const char* head, const std::vector<std::string>& texts) {
        if (!texts.empty()) {
            lines.emplace_back(head);
        }
        for (const auto& text : texts) {
            lines.push_back("  - " + text);
        }
    };
    list("Assumed, since nothing gives it; check it before an arm moves:", assumed_);
    list("Left out:", left_out_);
    return lines;
}

Result<ImportedRobot> Importer::run() {
    METIER_ASSIGN(const auto chosen_ends, ends());
    const auto choice = chooseChain(file_, tree_, chosen_ends);
    METIER_TRY(file_.finish());
    METIER_TRY(checkOptions(options_, choice->axes.size()));
    chain_text_ =
        fmt::format("{} ax{} from \"{}\" to \"{}\"{}", choice->axes.size(),
                    choice->axes.size() == 1 ? "is" : "es", tree_.links()[choice->base].name,
                    tree_.links()[choice->tip].name,
                    choice->why_this_tip.empty() ? "" : fmt::format(" ({})", choice->why_this_tip));
    METIER_ASSIGN(auto content, read(*choice));
    content.chain.home = middleOf(content.chain.joints);
    METIER_TRY(compareAngles(content.chain, content.other_frames));
    METIER_ASSIGN(content.chain.home, home(content.chain));
    auto text = modelText(content.appearance, content.chain, comments());
    METIER_ASSIGN(auto model, RobotModel::parse(text, file_.name()));
    auto planning = planningOf(model);
    return ImportedRobot{.model = std::move(model),
                         .text = std::move(text),
                         .base = tree_.links()[choice->base].name,
                         .tip = tree_.links()[choice->tip].name,
                         .chain = chain_text_,
                         .planning = std::move(planning),
                         .assumed = assumed_,
                         .left_out = left_out_,
                         .remarks = remarks_};
}

}  // namespace

Result<ImportedRobot> importUrdf(const SourceFile& urdf, const std::optional<SourceFile>& srdf,
                                 const ImportOptions& options) {
    METIER_ASSIGN(auto file, XmlFile::parse(urdf.text, urdf.name));
    const auto tree = RobotTree::read(file);
    METIER_TRY(file.finish());
    Importer importer(file, tree, options);
    if (!srdf) {
        return importer.run();
    }
    METIER_ASSIGN(auto semantics_file, XmlFile::parse(srdf->text, srdf->name));
    const auto semantics = Semantics::read(semantics_file);
    METIER_TRY(semantics_file.finish());
    importer.use(semantics);
    return importer.run();
}

}  // namespace metier::robot_files
