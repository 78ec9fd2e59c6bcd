#include "kdl_oracle.hpp"

namespace metier::motion {

namespace {

KDL::Frame toKdl(const motion::Pose& pose) {
    const auto& r = pose.rotation;
    const auto& t = pose.translation;
    return {KDL::Rotation::Quaternion(r.x(), r.y(), r.z(), r.w()), {t.x(), t.y(), t.z()}};
}

}  // namespace

KdlOracle::KdlOracle(const ChainDescription& description)
    : chain_(makeChain(description)), forward_(chain_), jacobian_(chain_) {}

KDL::Chain KdlOracle::makeChain(const ChainDescription& description) {
    KDL::Chain chain;
    for (const JointDescription& joint : description.joints) {
        chain.addSegment(
            KDL::Segment(KDL::Joint(KDL::Joint::None), toKdl(joint.parent_from_joint)));
        const KDL::Vector axis(joint.axis.x(), joint.axis.y(), joint.axis.z());
        chain.addSegment(KDL::Segment(KDL::Joint({0, 0, 0}, axis, KDL::Joint::RotAxis)));
    }
    chain.addSegment(
        KDL::Segment(KDL::Joint(KDL::Joint::None), toKdl(description.last_from_flange)));
    return chain;
}

KDL::JntArray KdlOracle::joints(const JointVector& q) const {
    KDL::JntArray array(static_cast<unsigned>(q.size()));
    for (unsigned i = 0; i < array.rows(); ++i) {
        array(i) = q[i];
    }
    return array;
}

motion::Pose KdlOracle::forward(const JointVector& q) {
    KDL::Frame frame;
    forward_.JntToCart(joints(q), frame);
    Eigen::Quaterniond rotation;
    frame.M.GetQuaternion(rotation.x(), rotation.y(), rotation.z(), rotation.w());
    return {{frame.p.x(), frame.p.y(), frame.p.z()}, rotation};
}

Jacobian KdlOracle::jacobian(const JointVector& q) {
    KDL::Jacobian jacobian(static_cast<unsigned>(q.size()));
    jacobian_.JntToJac(joints(q), jacobian);
    return jacobian.data;
}

}  // namespace metier::motion
