// Reads models/*.toml; models/README.md lists every key.

#include <fmt/format.h>

#include <algorithm>
#include <numbers>

#include "metier/cell/toml_file.hpp"
#include "metier/motion/frame.hpp"
#include "metier/motion/robot_model.hpp"

namespace metier::motion {

namespace {

using cell::TomlFile;
using cell::TomlTable;

/// A required list of so many numbers.
std::vector<double> numbers(const TomlTable& table, std::string_view key, std::size_t count) {
    std::vector<double> values = table.numbers(key);
    if (table.has(key) && values.size() != count) {
        table.reject(key, fmt::format("not {} finite numbers", count));
    }
    values.resize(count);
    return values;
}

Eigen::Vector3d vector(const TomlTable& table, std::string_view key) {
    const std::vector<double> values = numbers(table, key, 3);
    return {values[0], values[1], values[2]};
}

double positive(const TomlTable& table, std::string_view key) {
    const double value = table.number(key);
    if (table.has(key) && value <= 0) {
        table.reject(key, fmt::format("{} is not over 0", value));
    }
    return value;
}

/// 0 to end - 1.
std::size_t index(const TomlTable& table, std::string_view key, std::size_t end) {
    if (!table.has(key)) {
        table.reject(key, "missing");
    }
    return static_cast<std::size_t>(table.integerOr(key, 0, 0, static_cast<std::int64_t>(end) - 1));
}

/// Keys of an angle in the file: `key` in rad or `key`_deg in degrees.
struct AngleKey {
    std::string key;
    double factor = 1;
    double divisor = 1;

    double toRadians(double value) const { return value * factor / divisor; }
};

AngleKey angleKey(const TomlTable& table, std::string_view key) {
    std::string degrees = std::string(key) + "_deg";
    if (!table.has(degrees)) {
        return {std::string(key)};
    }
    if (table.has(key)) {
        table.reject(key, "given twice, in rad and in degrees");
    }
    return {std::move(degrees), std::numbers::pi, 180.0};
}

double angle(const TomlTable& table, std::string_view key) {
    const AngleKey in_file = angleKey(table, key);
    return in_file.toRadians(table.number(in_file.key));
}

double angleOrZero(const TomlTable& table, std::string_view key) {
    const AngleKey in_file = angleKey(table, key);
    return in_file.toRadians(table.numberOr(in_file.key, 0.0));
}

std::vector<double> angles(const TomlTable& table, std::string_view key, std::size_t count) {
    const AngleKey in_file = angleKey(table, key);
    std::vector<double> values = numbers(table, in_file.key, count);
    for (double& value : values) {
        value = in_file.toRadians(value);
    }
    return values;
}

Pose readFrame(const TomlTable& table, std::string_view key) {
    const std::vector<double> v = numbers(table, key, 6);
    return toPose({v[0], v[1], v[2], v[3], v[4], v[5]});
}

Pose turnAbout(const Eigen::Vector3d& axis, double angle) {
    return {Eigen::Vector3d::Zero(), Eigen::Quaterniond(Eigen::AngleAxisd(angle, axis))};
}

/// Content of a joint's row: the joint itself and the transform after it.
struct JointRow {
    JointDescription joint;
    Pose before;  ///< turns the joint frame by the row's offset
    Pose after;   ///< to the next joint's frame or the flange
};

JointLimits readLimits(const TomlTable& table) {
    const std::vector<double> range = angles(table, "position", 2);
    return {.lower = range[0],
            .upper = range[1],
            .velocity = angle(table, "velocity"),
            .acceleration = angle(table, "acceleration"),
            .jerk = angle(table, "jerk")};
}

/// T = Rz(q + offset) Tz(d) Tx(a) Rx(alpha)
void readDh(const TomlTable& dh, JointRow& row) {
    const double d = dh.number("d");
    const double a = dh.number("a");
    const double alpha = angle(dh, "alpha");
    row.before = turnAbout(Eigen::Vector3d::UnitZ(), angleOrZero(dh, "offset"));
    row.after = turnAbout(Eigen::Vector3d::UnitX(), alpha);
    row.after.translation = {a, 0, d};
}

JointRow readJoint(const TomlTable& table) {
    JointRow row;
    row.joint.name = table.text("name");
    row.joint.limits = readLimits(table);
    if (table.has("dh")) {
        readDh(table.table("dh"), row);
    } else {
        row.before = readFrame(table, "origin");
        row.joint.axis = vector(table, "axis");
    }
    return row;
}

void readJoints(const TomlTable& root, ChainDescription& chain) {
    Pose after_last;
    for (const TomlTable& table : root.tables("joint")) {
        JointRow row = readJoint(table);
        row.joint.parent_from_joint = after_last * row.before;
        after_last = row.after;
        chain.joints.push_back(row.joint);
    }
    chain.last_from_flange =
        root.has("flange") ? after_last * readFrame(root, "flange") : after_last;
    if (chain.joints.empty() || chain.joints.size() > kMaxAxes) {
        root.reject("joint", fmt::format("{} axes, not 1 to {}", chain.joints.size(), kMaxAxes));
    }
}

CartesianLimits readCartesian(const TomlTable& table) {
    return {.velocity = positive(table, "velocity"),
            .acceleration = positive(table, "acceleration"),
            .jerk = positive(table, "jerk"),
            .angular_velocity = positive(table, "angular_velocity"),
            .angular_acceleration = positive(table, "angular_acceleration"),
            .angular_jerk = positive(table, "angular_jerk")};
}

ToolFrame readTool(const TomlTable& table) {
    ToolFrame tool;
    tool.name = table.text("name");
    tool.flange_from_tool = readFrame(table, "frame");
    tool.mass = table.numberOr("mass", 0.0);
    if (table.has("centre_of_mass")) {
        tool.centre_of_mass = vector(table, "centre_of_mass");
    }
    return tool;
}

Capsule readCapsule(const TomlTable& table, std::size_t link_count) {
    Capsule capsule;
    capsule.link = index(table, "link", link_count);
    capsule.from = vector(table, "from");
    capsule.to = vector(table, "to");
    capsule.radius = positive(table, "radius");
    return capsule;
}

VisualPrimitive readVisual(const TomlTable& table, std::size_t link_count) {
    VisualPrimitive visual;
    visual.link = index(table, "link", link_count);
    visual.from = vector(table, "from");
    visual.to = vector(table, "to");
    visual.from_radius = positive(table, "from_radius");
    visual.to_radius = table.numberOr("to_radius", visual.from_radius);
    const std::vector<double> color = numbers(table, "color", 3);
    visual.color = {color[0], color[1], color[2]};
    if (table.has("edge")) {
        visual.edge = positive(table, "edge");
    }
    return visual;
}

ChainDescription readChain(const TomlTable& root) {
    ChainDescription chain;
    chain.cycle_time = positive(root, "cycle_time");
    readJoints(root, chain);
    const std::vector<double> home = angles(root, "home", chain.joints.size());
    chain.home = JointVector::from(home).value_or(JointVector{});
    chain.cartesian_limits = readCartesian(root.table("cartesian"));
    for (const TomlTable& table : root.tables("tool")) {
        chain.tools.push_back(readTool(table));
    }
    return chain;
}

/// A pair of link numbers, such as [1, 5].
void readUncompared(const cell::TomlValue& pair, std::size_t link_count,
                    RobotAppearance& appearance) {
    std::vector<std::size_t> links;
    for (const cell::TomlValue& item : pair.items()) {
        const auto link = item.integer();
        if (link && *link >= 0 && *link < static_cast<std::int64_t>(link_count)) {
            links.push_back(static_cast<std::size_t>(*link));
        }
    }
    if (links.size() != 2 || pair.items().size() != 2 || links[0] == links[1]) {
        pair.reject(fmt::format("not two different links of 0 to {}", link_count - 1));
        return;
    }
    appearance.not_compared.push_back({links[0], links[1]});
}

void readNotCompared(const TomlTable& root, std::size_t link_count, RobotAppearance& appearance) {
    const auto pairs = root.value("not_compared");
    if (pairs && !pairs->isList()) {
        pairs->reject("not a list of pairs of links");
    } else if (pairs) {
        for (const cell::TomlValue& pair : pairs->items()) {
            readUncompared(pair, link_count, appearance);
        }
    }
}

void readShape(const TomlTable& root, std::size_t link_count, RobotAppearance& appearance) {
    for (const TomlTable& table : root.tables("capsule")) {
        appearance.capsules.push_back(readCapsule(table, link_count));
    }
    if (appearance.capsules.size() > kMostCapsules) {
        root.reject("capsule", fmt::format("{} capsules; self-collision compares {} at most",
                                           appearance.capsules.size(), kMostCapsules));
    }
    for (const TomlTable& table : root.tables("visual")) {
        appearance.visual.push_back(readVisual(table, link_count));
    }
    readNotCompared(root, link_count, appearance);
}

}  // namespace

Result<RobotModel> RobotModel::load(const std::filesystem::path& path) {
    const auto toml = TomlFile::load(path);
    return toml ? read(*toml, path.string()) : fail(toml.error());
}

Result<RobotModel> RobotModel::parse(std::string_view text, const std::string& name) {
    const auto toml = TomlFile::parse(text, name);
    return toml ? read(*toml, name) : fail(toml.error());
}

Result<RobotModel> RobotModel::read(const TomlFile& toml, const std::string& file_name) {
    const TomlTable root = toml.root();
    RobotAppearance appearance{
        root.text("name"), root.text("maker"), root.text("product"), {}, {}, {}};
    ChainDescription chain = readChain(root);
    readShape(root, chain.joints.size() + 1, appearance);
    METIER_TRY(toml.finish());
    auto model = fromChain(std::move(chain));
    if (!model) {
        return fail(model.error().code, file_name + ": " + model.error().message);
    }
    model->appearance_ = std::move(appearance);
    return model;
}

}  // namespace metier::motion
