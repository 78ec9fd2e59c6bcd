// Reads models/*.toml; models/README.md tells every key.

#include <numbers>

#include "metier/geometry/frame.hpp"
#include "metier/motion/robot_model.hpp"
#include "toml_reader.hpp"

namespace metier::motion {

namespace {

using geometry::Pose;

Pose readFrame(TomlReader::Table& table, std::string_view key) {
    const std::vector<double> v = table.numbers(key, 6);
    return geometry::toPose({v[0], v[1], v[2], v[3], v[4], v[5]});
}

Pose turnAbout(const Eigen::Vector3d& axis, double angle) {
    return {Eigen::Vector3d::Zero(), Eigen::Quaterniond(Eigen::AngleAxisd(angle, axis))};
}

/// What a joint's row says: the joint itself and what follows it.
struct JointRow {
    JointDescription joint;
    Pose before;  ///< turns the joint frame by the row's offset
    Pose after;   ///< to the next joint's frame or the flange
};

JointLimits readLimits(TomlReader::Table& table) {
    const std::vector<double> range = table.angles("position", 2);
    JointLimits limits;
    limits.lower = range[0];
    limits.upper = range[1];
    limits.velocity = table.angle("velocity");
    limits.acceleration = table.angle("acceleration");
    limits.jerk = table.angle("jerk");
    return limits;
}

/// T = Rz(q + offset) Tz(d) Tx(a) Rx(alpha)
void readDh(TomlReader::Table dh, JointRow& row) {
    const double d = dh.number("d");
    const double a = dh.number("a");
    const double alpha = dh.angle("alpha");
    row.before = turnAbout(Eigen::Vector3d::UnitZ(), dh.angle("offset", 0.0));
    row.after = turnAbout(Eigen::Vector3d::UnitX(), alpha);
    row.after.translation = {a, 0, d};
    dh.refuseOtherKeys();
}

JointRow readJoint(TomlReader::Table& table) {
    JointRow row;
    row.joint.name = table.text("name");
    row.joint.limits = readLimits(table);
    if (table.has("dh")) {
        readDh(table.table("dh"), row);
    } else {
        row.before = readFrame(table, "origin");
        row.joint.axis = table.vector("axis");
    }
    table.refuseOtherKeys();
    return row;
}

void readChain(TomlReader::Table& root, ChainDescription& chain) {
    Pose after_last;
    for (TomlReader::Table& table : root.tables("joint")) {
        JointRow row = readJoint(table);
        row.joint.parent_from_joint = after_last * row.before;
        after_last = row.after;
        chain.joints.push_back(row.joint);
    }
    chain.last_from_flange =
        root.has("flange") ? after_last * readFrame(root, "flange") : after_last;
    if (chain.joints.empty() || chain.joints.size() > kMaxAxes) {
        root.refuse("joint", fmt::format("{} axes, not 1 to {}", chain.joints.size(), kMaxAxes));
    }
}

CartesianLimits readCartesian(TomlReader::Table table) {
    CartesianLimits limits;
    limits.velocity = table.positive("velocity");
    limits.acceleration = table.positive("acceleration");
    limits.jerk = table.positive("jerk");
    limits.angular_velocity = table.positive("angular_velocity");
    limits.angular_acceleration = table.positive("angular_acceleration");
    limits.angular_jerk = table.positive("angular_jerk");
    table.refuseOtherKeys();
    return limits;
}

ToolFrame readTool(TomlReader::Table& table) {
    ToolFrame tool;
    tool.name = table.text("name");
    tool.flange_from_tool = readFrame(table, "frame");
    tool.mass = table.number("mass", 0.0);
    if (table.has("centre_of_mass")) {
        tool.centre_of_mass = table.vector("centre_of_mass");
    }
    table.refuseOtherKeys();
    return tool;
}

Capsule readCapsule(TomlReader::Table& table, std::size_t link_count) {
    Capsule capsule;
    capsule.link = table.index("link", link_count);
    capsule.from = table.vector("from");
    capsule.to = table.vector("to");
    capsule.radius = table.positive("radius");
    table.refuseOtherKeys();
    return capsule;
}

VisualPrimitive readVisual(TomlReader::Table& table, std::size_t link_count) {
    VisualPrimitive visual;
    visual.link = table.index("link", link_count);
    visual.from = table.vector("from");
    visual.to = table.vector("to");
    visual.from_radius = table.positive("from_radius");
    visual.to_radius = table.number("to_radius", visual.from_radius);
    const std::vector<double> color = table.numbers("color", 3);
    visual.color = {color[0], color[1], color[2]};
    table.refuseOtherKeys();
    return visual;
}

struct ModelFile {
    std::string name;
    std::string maker;
    std::string product;
    ChainDescription chain;
    std::vector<Capsule> capsules;
    std::vector<VisualPrimitive> visual;
};

ModelFile readModel(TomlReader::Table root) {
    ModelFile file;
    file.name = root.text("name");
    file.maker = root.text("maker");
    file.product = root.text("product");
    file.chain.cycle_time = root.positive("cycle_time");
    readChain(root, file.chain);
    const std::vector<double> home = root.angles("home", file.chain.joints.size());
    file.chain.home = JointVector::from(home).value_or(JointVector{});
    file.chain.cartesian_limits = readCartesian(root.table("cartesian"));
    for (TomlReader::Table& table : root.tables("tool")) {
        file.chain.tools.push_back(readTool(table));
    }
    const std::size_t link_count = file.chain.joints.size() + 1;
    for (TomlReader::Table& table : root.tables("capsule")) {
        file.capsules.push_back(readCapsule(table, link_count));
    }
    for (TomlReader::Table& table : root.tables("visual")) {
        file.visual.push_back(readVisual(table, link_count));
    }
    root.refuseOtherKeys();
    return file;
}

Result<toml::table> parseFile(const std::filesystem::path& path) {
    if (!std::filesystem::exists(path)) {
        return fail(Errc::not_found, "no robot model file " + path.string());
    }
    try {
        return toml::parse_file(path.string());
    } catch (const toml::parse_error& error) {
        return fail(Errc::invalid_argument,
                    fmt::format("{}:{}: {}", path.string(), error.source().begin.line,
                                error.description()));
    }
}

}  // namespace

Result<RobotModel> RobotModel::load(const std::filesystem::path& path) {
    const auto table = parseFile(path);
    if (!table) {
        return fail(table.error());
    }
    TomlReader reader(path.string());
    ModelFile file = readModel(TomlReader::Table(reader, *table, ""));
    if (reader.error()) {
        return fail(*reader.error());
    }
    auto model = fromChain(std::move(file.chain));
    if (!model) {
        return fail(model.error().code, path.string() + ": " + model.error().message);
    }
    model->name_ = std::move(file.name);
    model->maker_ = std::move(file.maker);
    model->product_ = std::move(file.product);
    model->capsules_ = std::move(file.capsules);
    model->visual_ = std::move(file.visual);
    return model;
}

}  // namespace metier::motion
