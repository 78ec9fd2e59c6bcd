#include "world.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace metier::virtual_world {
namespace {

constexpr double kGravity = 9.81;  // [m/s2]
// Reports of times closer together than this give no new velocity [s].
constexpr double kShortestStep = 5e-4;
// Jaws that are open so much wider than a part let it go [m].
constexpr double kSlack = 1e-3;

/// Half of the extent of a box along a direction [m]; `direction` in the box's frame.
double halfExtent(const Eigen::Vector3d& size, const Eigen::Vector3d& direction) {
    return 0.5 * size.cwiseProduct(direction.cwiseAbs()).sum();
}

/// Width of a part between jaws that close along their x axis [m].
double widthBetween(const motion::Pose& world_from_jaws, const Part& part) {
    const Eigen::Vector3d closing = world_from_jaws.rotation * Eigen::Vector3d::UnitX();
    return 2.0 * halfExtent(part.size, part.world_from_part.rotation.conjugate() * closing);
}

}  // namespace

World::World(WorldOptions options) : options_(std::move(options)) {}

const Mount& World::mountOf(const std::string& controller) const {
    static const Mount kNone;
    const auto found = options_.mounts.find(controller);
    return found == options_.mounts.end() ? kNone : found->second;
}

WorldEffect World::report(const std::string& controller, const WorldReport& report) {
    if (report.base_from_flange) {
        moveArm(controller, *report.base_from_flange, report.time);
    }
    WorldEffect effect;
    if (report.jaw_width) {
        effect.part_width = grip(controller, report);
    }
    const auto& on = mountOf(controller).on;
    effect.wrench = wrenchOn(on.empty() ? controller : on);
    return effect;
}

void World::moveArm(const std::string& controller, const motion::Pose& base_from_flange,
                    double time) {
    const auto& mount = mountOf(controller);
    const auto world_from_flange = mount.world_from_base * base_from_flange;
    const Eigen::Vector3d contact = world_from_flange * mount.contact_point;
    auto [entry, first] = arms_.try_emplace(
        controller, Arm{world_from_flange, contact, Eigen::Vector3d::Zero(), time});
    auto& arm = entry->second;
    const double elapsed = time - arm.time;
    if (elapsed < 0.0) {  // its controller was started again
        arm = {world_from_flange, contact, Eigen::Vector3d::Zero(), time};
    } else if (!first && elapsed >= kShortestStep) {
        arm.contact_velocity = (contact - arm.contact) / elapsed;
        arm.contact = contact;
        arm.time = time;
    }
    arm.world_from_flange = world_from_flange;
    for (auto& [name, part] : options_.parts) {
        if (!part.held_by.empty()) {
            const auto& gripper = mountOf(part.held_by);
            if (gripper.on == controller || part.held_by == controller) {
                part.world_from_part =
                    world_from_flange * gripper.flange_from_jaws * part.jaws_from_part;
            }
        }
    }
}

std::optional<double> World::grip(const std::string& controller, const WorldReport& report) {
    const auto& mount = mountOf(controller);
    const auto flange = flangeOf(mount.on.empty() ? controller : mount.on);
    const auto world_from_jaws =
        (flange ? *flange : mount.world_from_base) * mount.flange_from_jaws;
    for (auto& [name, part] : options_.parts) {
        if (part.held_by == controller) {
            const double width = widthBetween(world_from_jaws, part);
            if (*report.jaw_width < width + kSlack) {
                return width;
            }
            release(part);
        }
        if (part.held_by.empty() && isBetween(world_from_jaws, *report.jaw_width, part)) {
            if (report.gripping) {
                part.held_by = controller;
                part.jaws_from_part = world_from_jaws.inverse() * part.world_from_part;
            }
            return widthBetween(world_from_jaws, part);
        }
    }
    return std::nullopt;
}

bool World::isBetween(const motion::Pose& world_from_jaws, double jaw_width,
                      const Part& part) const {
    const Eigen::Vector3d centre = world_from_jaws.inverse() * part.world_from_part.translation;
    const double room = 0.5 * std::max(0.0, jaw_width - widthBetween(world_from_jaws, part)) +
                        options_.part_tolerance;
    return std::abs(centre.x()) <= room &&
           std::abs(centre.y()) <= 0.5 * part.size.y() + options_.part_tolerance &&
           std::abs(centre.z()) <= 0.5 * part.size.z() + options_.part_tolerance;
}

void World::release(Part& part) const {
    part.held_by.clear();
    if (options_.table_height) {
        auto& pose = part.world_from_part;
        const Eigen::Vector3d up = pose.rotation.conjugate() * Eigen::Vector3d::UnitZ();
        pose.translation.z() = *options_.table_height + halfExtent(part.size, up);
    }
}

motion::Wrench World::wrenchOn(const std::string& arm) const {
    const auto found = arms_.find(arm);
    if (found == arms_.end()) {
        return {};
    }
    const auto& [world_from_flange, contact, velocity, time] = found->second;
    Eigen::Vector3d force = Eigen::Vector3d::Zero();
    for (const auto& wall : options_.walls) {
        const double depth = -wall.normal.dot(contact - wall.point);
        if (depth > 0.0) {
            const double approach = -wall.normal.dot(velocity);
            force += std::max(0.0, wall.stiffness * depth + wall.damping * approach) * wall.normal;
        }
    }
    motion::Wrench wrench;
    const auto flange_from_world = world_from_flange.rotation.conjugate();
    wrench.force = flange_from_world * force;
    wrench.torque = mountOf(arm).contact_point.cross(wrench.force);
    for (const auto& [name, part] : options_.parts) {
        if (part.held_by == arm || mountOf(part.held_by).on == arm) {
            const Eigen::Vector3d weight =
                flange_from_world * Eigen::Vector3d(0.0, 0.0, -kGravity * part.mass);
            wrench.force += weight;
            const Eigen::Vector3d lever =
                world_from_flange.inverse() * part.world_from_part.translation;
            wrench.torque += lever.cross(weight);
        }
    }
    return wrench;
}

void World::drop(const std::string& gripper) {
    for (auto& [name, part] : options_.parts) {
        if (!part.held_by.empty() && (gripper.empty() || part.held_by == gripper)) {
            release(part);
            // Out of reach of jaws that are still closed around where it was.
            part.world_from_part.translation.y() += 2.0 * part.size.y() + 0.1;
        }
    }
}

Result<void> World::place(const std::string& part, const Eigen::Vector3d& position) {
    const auto found = options_.parts.find(part);
    if (found == options_.parts.end()) {
        return fail(Errc::not_found, "no part " + part);
    }
    found->second.held_by.clear();
    found->second.world_from_part = {position, Eigen::Quaterniond::Identity()};
    return {};
}

Result<void> World::remove(const std::string& part) {
    if (options_.parts.erase(part) == 0) {
        return fail(Errc::not_found, "no part " + part);
    }
    return {};
}

std::optional<motion::Pose> World::flangeOf(const std::string& controller) const {
    const auto found = arms_.find(controller);
    if (found == arms_.end()) {
        return std::nullopt;
    }
    return found->second.world_from_flange;
}

}  // namespace metier::virtual_world
