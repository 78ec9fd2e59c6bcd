#include "kdl_urdf.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <pugixml.hpp>
#include <sstream>
#include <stdexcept>
#include <vector>

namespace metier::robot_files {

namespace {

KDL::Vector vectorOf(const char* text, const KDL::Vector& otherwise) {
    KDL::Vector v = otherwise;
    std::istringstream words(text);
    words.imbue(std::locale::classic());
    if (*text != '\0') {
        words >> v(0) >> v(1) >> v(2);
    }
    return v;
}

/// A segment as ROS' kdl_parser makes it: the joint in the frame of the link before.
KDL::Segment segmentOf(const pugi::xml_node& joint) {
    const auto origin = joint.child("origin");
    const auto xyz = vectorOf(origin.attribute("xyz").value(), KDL::Vector::Zero());
    const auto rpy = vectorOf(origin.attribute("rpy").value(), KDL::Vector::Zero());
    const KDL::Frame frame(KDL::Rotation::RPY(rpy.x(), rpy.y(), rpy.z()), xyz);
    const std::string name = joint.attribute("name").value();
    const std::string type = joint.attribute("type").value();
    if (type == "fixed") {
        return KDL::Segment(name, KDL::Joint(name, KDL::Joint::None), frame);
    }
    if (type != "revolute" && type != "continuous") {
        throw std::runtime_error(name + " does not turn");
    }
    const auto axis = vectorOf(joint.child("axis").attribute("xyz").value(), {1, 0, 0});
    return KDL::Segment(name, KDL::Joint(name, frame.p, frame.M * axis, KDL::Joint::RotAxis),
                        frame);
}

pugi::xml_node jointTo(const pugi::xml_node& robot, const std::string& link) {
    return robot.find_child([&](const pugi::xml_node& node) {
        return std::string(node.name()) == "joint" &&
               link == node.child("child").attribute("link").value();
    });
}

}  // namespace

KDL::Chain KdlUrdf::read(const std::string& urdf, const std::string& base, const std::string& tip) {
    pugi::xml_document document;
    document.load_string(urdf.c_str());
    std::vector<KDL::Segment> segments;
    for (std::string link = tip; link != base;) {
        const auto joint = jointTo(document.child("robot"), link);
        if (!joint) {
            throw std::runtime_error(fmt::format("no chain from {} to {}", base, tip));
        }
        segments.push_back(segmentOf(joint));
        link = joint.child("parent").attribute("link").value();
    }
    KDL::Chain chain;
    std::for_each(segments.rbegin(), segments.rend(),
                  [&](const KDL::Segment& segment) { chain.addSegment(segment); });
    return chain;
}

KdlUrdf::KdlUrdf(const std::string& urdf, const std::string& base, const std::string& tip)
    : chain_(read(urdf, base, tip)), forward_(chain_) {}

motion::Pose KdlUrdf::forward(const motion::JointVector& q) {
    KDL::JntArray joints(static_cast<unsigned>(q.size()));
    for (unsigned i = 0; i < joints.rows(); ++i) {
        joints(i) = q[i];
    }
    KDL::Frame frame;
    forward_.JntToCart(joints, frame);
    Eigen::Quaterniond rotation;
    frame.M.GetQuaternion(rotation.x(), rotation.y(), rotation.z(), rotation.w());
    return {{frame.p.x(), frame.p.y(), frame.p.z()}, rotation};
}

}  // namespace metier::robot_files
