#include "cabinet.hpp"

namespace metier::virtual_iiwa {

motion::JointVector Cabinet::externalTorque() const {
    const auto jacobian = arm.model().kinematics().jacobian(arm.position());
    const auto flange = arm.model().kinematics().forward(arm.position());
    Eigen::Matrix<double, 6, 1> base_wrench;
    base_wrench << flange.rotation * wrench.force, flange.rotation * wrench.torque;
    motion::JointVector torque = torque_noise;
    torque.view() += jacobian.transpose() * base_wrench;
    return torque;
}

}  // namespace metier::virtual_iiwa
