#include "model_text.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <iterator>

#include "metier/motion/frame.hpp"

namespace metier::robot_files {

namespace {

using Eigen::Vector3d;

bool isControl(char letter) {
    const auto byte = static_cast<unsigned char>(letter);
    return byte < 0x20 || byte == 0x7F;
}

/// A basic string of TOML.
std::string tomlString(std::string_view text) {
    std::string result = "\"";
    for (const char letter : text) {
        if (letter == '"' || letter == '\\') {
            result += '\\';
            result += letter;
        } else if (isControl(letter)) {
            result += fmt::format("\\u{:04X}", static_cast<unsigned char>(letter));
        } else {
            result += letter;
        }
    }
    return result + '"';
}

// Adding 0 leaves no -0.
std::string vectorText(const Vector3d& v) {
    return fmt::format("[{}, {}, {}]", v.x() + 0.0, v.y() + 0.0, v.z() + 0.0);
}

std::string frameText(const motion::Pose& pose) {
    const auto frame = motion::toFrame(pose);
    return fmt::format("[{}, {}, {}, {}, {}, {}]", frame.x + 0.0, frame.y + 0.0, frame.z + 0.0,
                       frame.a + 0.0, frame.b + 0.0, frame.c + 0.0);
}

class ModelWriter {
public:
    void comment(std::string text) {
        std::replace_if(text.begin(), text.end(), &isControl, '?');
        add("# {}\n", text);
    }
    void head(const motion::RobotAppearance& appearance, const motion::ChainDescription& chain);
    void cartesian(const motion::CartesianLimits& limits);
    void joint(const motion::JointDescription& joint);
    void tool(const motion::ToolFrame& tool);
    void capsule(const motion::Capsule& capsule);
    void visual(const motion::VisualPrimitive& visual);
    const std::string& text() const { return text_; }

private:
    template <typename... Values>
    void add(fmt::format_string<Values...> format, Values&&... values) {
        fmt::format_to(std::back_inserter(text_), format, std::forward<Values>(values)...);
    }

    std::string text_;
};

void ModelWriter::head(const motion::RobotAppearance& appearance,
                       const motion::ChainDescription& chain) {
    add("name = {}\nmaker = {}\nproduct = {}\n", tomlString(appearance.name),
        tomlString(appearance.maker), tomlString(appearance.product));
    add("cycle_time = {}  # s\n", chain.cycle_time);
    add("home = [{}]  # rad\n", fmt::join(chain.home.begin(), chain.home.end(), ", "));
    add("flange = {}  # x y z [m], a b c [rad] in the last joint's frame\n",
        frameText(chain.last_from_flange));
    if (!appearance.not_compared.empty()) {
        std::vector<std::string> pairs;
        for (const auto& pair : appearance.not_compared) {
            pairs.push_back(fmt::format("[{}, {}]", pair.first, pair.second));
        }
        add("not_compared = [{}]  # pairs of links\n", fmt::join(pairs, ", "));
    }
}

void ModelWriter::cartesian(const motion::CartesianLimits& limits) {
    add("\n[cartesian]  # m/s, m/s2, m/s3, rad/s, rad/s2, rad/s3\n");
    add("velocity = {}\nacceleration = {}\njerk = {}\n", limits.velocity, limits.acceleration,
        limits.jerk);
    add("angular_velocity = {}\nangular_acceleration = {}\nangular_jerk = {}\n",
        limits.angular_velocity, limits.angular_acceleration, limits.angular_jerk);
}

void ModelWriter::joint(const motion::JointDescription& joint) {
    const auto& limits = joint.limits;
    add("\n[[joint]]\nname = {}\norigin = {}\naxis = {}\n", tomlString(joint.name),
        frameText(joint.parent_from_joint), vectorText(joint.axis));
    add("position = [{}, {}]\nvelocity = {}\nacceleration = {}\njerk = {}\n", limits.lower,
        limits.upper, limits.velocity, limits.acceleration, limits.jerk);
}

void ModelWriter::tool(const motion::ToolFrame& tool) {
    add("\n[[tool]]\nname = {}\nframe = {}\n", tomlString(tool.name),
        frameText(tool.flange_from_tool));
    if (tool.mass > 0) {
        add("mass = {}\ncentre_of_mass = {}\n", tool.mass, vectorText(tool.centre_of_mass));
    }
}

void ModelWriter::capsule(const motion::Capsule& capsule) {
    add("\n[[capsule]]\nlink = {}\nfrom = {}\nto = {}\nradius = {}\n", capsule.link,
        vectorText(capsule.from), vectorText(capsule.to), capsule.radius);
}

void ModelWriter::visual(const motion::VisualPrimitive& visual) {
    add("\n[[visual]]\nlink = {}\nfrom = {}\nto = {}\nfrom_radius = {}\n", visual.link,
        vectorText(visual.from), vectorText(visual.to), visual.from_radius);
    if (visual.to_radius != visual.from_radius) {
        add("to_radius = {}\n", visual.to_radius);
    }
    add("color = [{}]\n", fmt::join(visual.color, ", "));
    if (visual.edge > 0) {
        add("edge = {}\n", visual.edge);
    }
}

}  // namespace

std::string modelText(const motion::RobotAppearance& appearance,
                      const motion::ChainDescription& chain,
                      const std::vector<std::string>& comments) {
    ModelWriter writer;
    for (const auto& comment : comments) {
        writer.comment(comment);
    }
    writer.head(appearance, chain);
    writer.cartesian(chain.cartesian_limits);
    for (const auto& joint : chain.joints) {
        writer.joint(joint);
    }
    for (const auto& tool : chain.tools) {
        writer.tool(tool);
    }
    for (const auto& capsule : appearance.capsules) {
        writer.capsule(capsule);
    }
    for (const auto& visual : appearance.visual) {
        writer.visual(visual);
    }
    return writer.text();
}

}  // namespace metier::robot_files
