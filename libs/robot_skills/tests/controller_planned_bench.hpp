#pragma once

#include "bench.hpp"
#include "simulated_planner.hpp"

namespace metier::robot_skills {

/// An arm whose skills are run by the planner of its controller.
class ControllerPlannedBench {
public:
    explicit ControllerPlannedBench(const std::string& robot = "iiwa7",
                                    device::ForceTorqueSensor* sensor = nullptr)
        : bench(robot, {}, [this, sensor](auto& arm, const auto& model) {
              planner_ = std::make_unique<SimulatedPlanner>(arm, model);
              return ArmDevices{arm, planner_.get(), sensor};
          }) {}

    SimulatedPlanner& planner() { return *planner_; }

private:
    std::unique_ptr<SimulatedPlanner> planner_;

public:
    Bench bench;  // after the planner, which outlives its skills
};

}  // namespace metier::robot_skills
